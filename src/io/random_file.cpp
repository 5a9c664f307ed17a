#include "io/random_file.h"

#include "base/platform.h"

#include <g3r/error.h>
#include <g3r/io.h>

#include <cerrno>
#include <system_error>

namespace g3r::io {

RandomFile::RandomFile(const std::string& path) : path_(path), fd_(platform::open_to_read(path)) {
  const auto fail = [&](const std::string& reason) {
    if (fd_ >= 0) platform::close_file(fd_);
    throw IoError(IoError::Kind::kNotFound, escape_text(path_) + ": " + reason);
  };
  platform::FileStatus status;
  if (fd_ < 0 || !platform::get_status(fd_, status)) fail(std::generic_category().message(errno));
  if (status.kind != platform::FileStatus::Kind::kRegular) fail("not a regular file, which can be read more than once");
  size_ = status.bytes;
}

RandomFile::~RandomFile() { platform::close_file(fd_); }

void RandomFile::read(std::uint64_t offset, void* bytes, std::size_t count) const {
  for (std::size_t done = 0; done < count;) {
    const std::ptrdiff_t got = platform::read_at(fd_, offset + done, static_cast<char*>(bytes) + done, count - done);
    if (got <= 0) {
      const std::string reason = got < 0 ? std::generic_category().message(errno) : "it is shorter than it was";
      throw IoError(IoError::Kind::kFailed, escape_text(path_) + ": cannot read at byte " + std::to_string(offset + done) + ": " + reason);
    }
    done += static_cast<std::size_t>(got);
  }
}

}  // namespace g3r::io
