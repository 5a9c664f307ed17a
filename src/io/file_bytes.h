// The bytes of a file: in memory, or read when they are asked for.
#pragma once

#include "io/random_file.h"
#include "io/source.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace g3r::io {

class FileBytes {
 public:
  /// All of the source, which must outlive this.
  explicit FileBytes(const Source& source) : source_(source), size_(source.bytes.size()) {}
  /// `head`: the beginning of the file, maybe nothing, and its name. Both must outlive this.
  FileBytes(const Source& head, const RandomFile& file) : source_(head), file_(&file), size_(static_cast<std::size_t>(file.size())) {}

  /// For messages, and what is in memory anyway.
  [[nodiscard]] const Source& source() const { return source_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// [begin, begin + count), which lie within the file; valid until the next call. Throws IoError.
  std::string_view get(std::size_t begin, std::size_t count) {
    if (file_ == nullptr) return source_.bytes.substr(begin, count);
    buffer_.resize(count);
    file_->read(begin, buffer_.data(), count);
    return buffer_;
  }

 private:
  const Source& source_;
  const RandomFile* file_ = nullptr;
  std::size_t size_;
  std::string buffer_;
};

}  // namespace g3r::io
