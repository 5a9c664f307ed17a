// What the files of a work folder hold: records of one size, back to back, little-endian.
#pragma once

#include "io/random_file.h"

#include <g3r/points.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

static_assert(std::endian::native == std::endian::little, "records are stored as they are in memory");

/// Records read at once.
inline constexpr std::uint64_t kRecordsAtOnce = 4096;

/// A point and its place in the input.
struct Record {
  Vec3 point;
  std::uint64_t index;
};
static_assert(sizeof(Record) == 32);

/// The normal of a point of the thinned cloud.
struct CoarseNormal {
  std::array<float, 3> normal;
  float confidence;
  std::uint32_t open;  ///< 1: on a surface without an inside
};
static_assert(sizeof(CoarseNormal) == 20);

/// The result for an input point.
struct Result {
  std::uint64_t index;
  std::array<float, 3> normal;
  float confidence;
};
static_assert(sizeof(Result) == 24);

/// A file of records.
template <class T>
class RecordFile {
 public:
  /// Throws IoError.
  explicit RecordFile(const std::string& path) : file_(path) {}
  [[nodiscard]] std::uint64_t size() const { return file_.size() / sizeof(T); }
  /// Appends records [begin, end). Throws IoError if they are not there.
  void append(std::uint64_t begin, std::uint64_t end, std::vector<T>& records) const {
    const std::size_t before = records.size();
    records.resize(before + static_cast<std::size_t>(end - begin));
    file_.read(begin * sizeof(T), records.data() + before, static_cast<std::size_t>(end - begin) * sizeof(T));
  }

 private:
  io::RandomFile file_;
};

}  // namespace g3r::tiles
