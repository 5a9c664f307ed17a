// The points of a file, some at a time, in the order of the file.
#pragma once

#include "io/table.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// What a LAS file holds that a table does not show; of LAZ, the LAS file that it stands for.
class LasOrigin {
 public:
  virtual ~LasOrigin() = default;
  /// Header and variable length records.
  [[nodiscard]] virtual const std::string& head() const = 0;
  /// From now on next() appends the records of its points to `records` (may be null) as they are in the file.
  virtual void keep(std::string* records) = 0;
  /// Bytes that follow the points.
  [[nodiscard]] virtual std::uint64_t rest() const = 0;
  /// Calls take(bytes) for these, in pieces. Throws IoError.
  virtual void read_rest(const std::function<void(std::string_view)>& take) const = 0;
};

class PointStream {
 public:
  virtual ~PointStream() = default;
  /// Replaces `points` with the positions of the next ones, at most `most` (> 0); none at the end. `records` (null unless the stream was
  /// opened with them) gets their records, back to back, as table() lays them out. Throws IoError, and InvalidInput for what is damaged.
  virtual void next(std::size_t most, std::vector<Vec3>& points, std::string* records = nullptr) = 0;
  /// How many have not been returned yet.
  [[nodiscard]] virtual std::uint64_t left() const = 0;
  /// Precision of the coordinates in the file.
  [[nodiscard]] virtual Scalar scalar() const = 0;
  /// What the records hold: the element points() without data, and what the file says beside it.
  [[nodiscard]] virtual const Attributes& table() const = 0;
  /// What read_cloud() warns of, as far as it is known before the points are read.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
  /// Null for what is no LAS or LAZ file.
  [[nodiscard]] virtual LasOrigin* las() { return nullptr; }
};

/// Opens a file of any format that read_cloud() reads. Read piece by piece are LAS, LAZ and COPC (chunk by chunk), binary PLY
/// (little-endian, points first, no lists), binary PCD and NPY (little-endian, by rows), text (XYZ, CSV, PTS), PTX, ASCII grids and E57;
/// of others the whole file is in memory until the stream is gone. Opening a text, PTX, grid or E57 reads it through, and so does an NPY
/// with colours. Of the options `threads` and `cancel` count. Throws like read_cloud().
[[nodiscard]] std::unique_ptr<PointStream> open_points(const std::string& path, bool with_records = false, const ReadOptions& options = {});

}  // namespace g3r::io
