#include "io/source.h"

#include "base/platform.h"
#include "io/recognise.h"
#include "io/text.h"
#include "io/utf8.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace g3r {

namespace {

// Characters that move the cursor, change the terminal's state or reverse the reading direction.
bool is_control(unsigned code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || (code >= 0x200E && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string escape_text(const std::string& text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string safe;
  for (std::size_t i = 0; i < text.size();) {
    unsigned code = 0;
    const std::size_t length = io::utf8_length(std::string_view(text).substr(i), code);
    if (length != 0 && !is_control(code)) {
      safe.append(text, i, length);
      i += length;
      continue;
    }
    for (std::size_t k = 0; k < std::max<std::size_t>(length, 1); ++k, ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      safe += "\\x";
      safe += kDigits[byte >> 4];
      safe += kDigits[byte & 15];
    }
  }
  return safe;
}

namespace io {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;      // Bytes read at once: a file's size is not trusted, so memory grows as they come.
constexpr std::size_t kHeadBytes = std::size_t{1} << 16;  // So many bytes are enough to recognise every format.

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ > 0) platform::close_file(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

[[noreturn]] void fail_io(IoError::Kind kind, const std::string& path, int error) {
  throw IoError(kind, escape_text(path) + ": " + std::generic_category().message(error));
}

// Appends up to `count` bytes; false at the end of the file.
bool append_block(int fd, const std::string& path, std::size_t count, std::string& bytes) {
  const std::size_t before = bytes.size();
  bytes.resize(before + count);
  const std::ptrdiff_t got = platform::read_some(fd, bytes.data() + before, count);
  if (got < 0) fail_io(IoError::Kind::kFailed, path, errno);
  bytes.resize(before + static_cast<std::size_t>(got));
  return got > 0;
}

}  // namespace

std::string read_bytes(const std::string& path) {
  const bool standard_input = path == "-";
  const Descriptor file(standard_input ? platform::standard_input() : platform::open_to_read(path));
  if (file.get() < 0) fail_io(IoError::Kind::kNotFound, path, errno);
  platform::FileStatus status;
  if (!platform::get_status(file.get(), status)) fail_io(IoError::Kind::kFailed, path, errno);
  if (status.kind == platform::FileStatus::Kind::kFolder)
    throw IoError(IoError::Kind::kNotFound, escape_text(path) + ": a folder, not a file");

  std::string bytes;
  if (status.kind == platform::FileStatus::Kind::kRegular) {
    // One byte more than the size, so that the end of the file is seen without growing.
    bytes.reserve(static_cast<std::size_t>(status.bytes) + 1);
    while (append_block(file.get(), path, std::min(kBlock, std::max<std::size_t>(bytes.capacity() - bytes.size(), 1)), bytes)) {
    }
    return bytes;
  }
  while (bytes.size() < kHeadBytes && append_block(file.get(), path, kHeadBytes, bytes)) {
  }
  recognise({bytes, standard_input ? "standard input" : path});  // an endless stream of zeros ends here
  while (append_block(file.get(), path, kBlock, bytes)) {
  }
  return bytes;
}

std::string quote(std::string_view text) {
  constexpr std::size_t kClip = 40;  // Bytes shown of a text: a message stays one line.
  const bool clipped = text.size() > kClip;
  return '"' + escape_text(std::string(text.substr(0, kClip))) + (clipped ? "...\"" : "\"");
}

void fail(const Source& source, const std::string& what) { throw InvalidInput(escape_text(source.name) + ": " + what); }

void fail_without_faces(const Source& source, const std::string& what) { throw NoFaces(escape_text(source.name) + ": " + what); }

void fail_at_byte(const Source& source, std::size_t offset, const std::string& what) {
  fail(source, "byte " + std::to_string(offset) + ": " + what);
}

void fail_at_line(const Source& source, std::size_t line, const std::string& what) {
  fail(source, "line " + std::to_string(line) + ": " + what);
}

std::string extension(const std::string& path) {
  const std::size_t slash = path.find_last_of(platform::kSeparators);
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.find_last_of('.');
  if (dot == std::string::npos || dot + 1 == name.size()) return "";
  return lower_case(std::string_view(name).substr(dot + 1));
}

}  // namespace io
}  // namespace g3r
