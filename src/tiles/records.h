// What the files of a work folder hold: records of one size, back to back, little-endian.
#pragma once

#include "io/random_file.h"

#include <g3r/points.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
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
  float area;          ///< that it stands for, over the square of the spacing (Manifest::coarse_spacing); 0 of an outlier
  std::uint32_t open;  ///< 1: on a surface without an inside, and so are the points around it
};
static_assert(sizeof(CoarseNormal) == 24);

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

/// The records of a file from its beginning, some at a time. It is open only while it is read: there may be thousands.
template <class T>
class RecordPieces {
 public:
  RecordPieces(std::string path, std::uint64_t at_once) : path_(std::move(path)), at_once_(at_once) {}
  /// Replaces `records` by the next ones, at most `at_once`; by none at the end. Throws IoError.
  void next(std::vector<T>& records) {
    records.clear();
    const RecordFile<T> file(path_);
    const std::uint64_t end = std::min(file.size(), at_ + at_once_);
    file.append(at_, end, records);
    at_ = end;
  }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The number of the next record.
  [[nodiscard]] std::uint64_t at() const { return at_; }

 private:
  std::string path_;
  std::uint64_t at_once_;
  std::uint64_t at_ = 0;
};

}  // namespace g3r::tiles
