// A file that is written whole or not at all: temporary file in the same folder, checked writes, fsync, rename, fsync of the folder.
#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// Until commit() the old file, if any, is untouched; without commit() the temporary file is removed. An existing path that is no regular
/// file (a device, a pipe) and "-" (standard output) are written to directly. A symbolic link is followed, and an existing file's mode
/// kept. A temporary file left behind by a killed process is found by its unlocked state and reused by the next run.
class OutputFile {
 public:
  /// Throws IoError (kCannotCreate). Once `cancel` (may be null) becomes true, write() and commit() throw Cancelled.
  explicit OutputFile(const std::string& path, const std::atomic<bool>* cancel = nullptr);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends bytes. Throws IoError (kFailed).
  void write(const void* bytes, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Appends records as they are in memory.
  template <class T>
  void write_records(const std::vector<T>& records) {
    write(records.data(), records.size() * sizeof(T));
  }
  /// Whether overwrite() can be called: not where the bytes go to a device or a pipe.
  [[nodiscard]] bool can_overwrite() const { return !temporary_.empty(); }
  /// Puts bytes in the place of some that have been written, from `offset` on. Throws IoError (kFailed).
  void overwrite(std::size_t offset, std::string_view bytes);
  /// Makes the file take its place. Throws IoError (kFailed).
  void commit();

 private:
  void create_temporary(unsigned mode, bool keep_mode);
  void flush();
  [[noreturn]] void fail(bool creating, int error) const;

  std::string path_;       // for messages
  std::string target_;     // links resolved
  std::string temporary_;  // "" when written directly
  std::string buffer_;
  const std::atomic<bool>* cancel_;
  int fd_ = -1;
};

/// Whether both names are those of one file, also by links and where there is none yet. Standard input and output ("-") and "" are no
/// files.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Throws what OutputFile(path) would throw; leaves nothing behind.
void check_creatable(const std::string& path);

}  // namespace g3r::io
