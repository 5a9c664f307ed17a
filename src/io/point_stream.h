// The points of a file, some at a time, in the order of the file.
#pragma once

#include "io/table.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace g3r::io {

class PointStream {
 public:
  virtual ~PointStream() = default;
  /// Replaces `points` with the positions of the next ones, at most `most` (> 0); none at the end. `records` (null unless the stream was
  /// opened with them) gets their records, back to back, as table() lays them out. Throws IoError, and InvalidInput for what is damaged.
  virtual void next(std::size_t most, std::vector<Vec3>& points, std::string* records = nullptr) = 0;
  /// How many have not been handed out yet.
  [[nodiscard]] virtual std::uint64_t left() const = 0;
  /// Precision of the coordinates in the file.
  [[nodiscard]] virtual Scalar scalar() const = 0;
  /// What the records hold: the element points() without data, and what the file says beside it.
  [[nodiscard]] virtual const Attributes& table() const = 0;
};

/// Opens a file of any format that read_cloud() reads. Read piece by piece are LAS, LAZ and COPC (chunk by chunk), binary PLY
/// (little-endian, points first, no lists), binary PCD and NPY (little-endian, by rows); of others the whole file is in memory until the
/// stream is gone. Throws like read_cloud().
[[nodiscard]] std::unique_ptr<PointStream> open_points(const std::string& path, bool with_records = false);

}  // namespace g3r::io
