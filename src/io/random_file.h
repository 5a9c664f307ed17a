// A file that is read at any place, without its whole being in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace g3r::io {

/// A regular file, open for reading.
class RandomFile {
 public:
  /// Throws IoError: not found, or no regular file.
  explicit RandomFile(const std::string& path);
  ~RandomFile();
  RandomFile(const RandomFile&) = delete;
  RandomFile& operator=(const RandomFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Bytes when it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Reads `count` bytes from `offset` on. Throws IoError if there are fewer.
  void read(std::uint64_t offset, void* bytes, std::size_t count) const;

 private:
  std::string path_;
  int fd_;
  std::uint64_t size_ = 0;
};

}  // namespace g3r::io
