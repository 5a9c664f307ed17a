// Streams of points whose records have one size.
#pragma once

#include "io/point_stream.h"
#include "io/random_file.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace g3r::io {

/// A table whose records lie in a file as they are in memory.
struct StoredTable {
  Attributes table;         ///< one element, without data
  std::uint64_t begin = 0;  ///< byte offset of the first record
};

/// The table whose points, of a format in `dialect`, begin at this byte of a file; nothing where they are not all there.
std::optional<StoredTable> stored_table(Attributes::Dialect dialect, std::vector<std::string> comments, Element points, std::uint64_t begin,
                                        std::uint64_t file_size);

/// Records that lie one after the other in the file as in the table, unless fetch() says otherwise. The table has no lists.
class FixedRecords : public PointStream {
 public:
  /// The records begin at byte `begin`; how many there are, and that they have coordinates, the table says.
  FixedRecords(std::unique_ptr<RandomFile> file, std::uint64_t begin, Attributes table);

  void next(std::size_t most, std::vector<Vec3>& points, std::string* records) override;
  [[nodiscard]] std::uint64_t left() const override { return left_; }
  [[nodiscard]] Scalar scalar() const override;
  [[nodiscard]] const Attributes& table() const override { return table_; }

 protected:
  /// Replaces `records` with the next `count` (> 0) ones of the table; fewer only where the file has changed.
  virtual void fetch(std::size_t count, std::string& records) { read(count * layout_.size(), records); }
  /// The next bytes of the file.
  void read(std::size_t count, std::string& bytes);
  [[nodiscard]] const RandomFile& file() const { return *file_; }

 private:
  std::unique_ptr<RandomFile> file_;
  std::uint64_t at_;
  std::uint64_t left_;
  Attributes table_;
  RecordLayout layout_;
  std::array<std::size_t, 3> position_{};
  std::string bytes_;
};

}  // namespace g3r::io
