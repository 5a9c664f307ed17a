#include "io/random_file.h"

#include <g3r/error.h>
#include <g3r/io.h>

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace g3r::io {

RandomFile::RandomFile(const std::string& path) : path_(path), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  const auto fail = [&](const std::string& reason) {
    if (fd_ >= 0) ::close(fd_);
    throw IoError(IoError::Kind::kNotFound, escape_text(path_) + ": " + reason);
  };
  struct stat status {};
  if (fd_ < 0 || ::fstat(fd_, &status) != 0) fail(std::generic_category().message(errno));
  if (!S_ISREG(status.st_mode)) fail("not a regular file, which can be read more than once");
  size_ = static_cast<std::uint64_t>(status.st_size);
}

RandomFile::~RandomFile() { ::close(fd_); }

void RandomFile::read(std::uint64_t offset, void* bytes, std::size_t count) const {
  for (std::size_t done = 0; done < count;) {
    const ssize_t got = ::pread(fd_, static_cast<char*>(bytes) + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      const std::string reason = got < 0 ? std::generic_category().message(errno) : "it is shorter than it was";
      throw IoError(IoError::Kind::kFailed, escape_text(path_) + ": cannot read at byte " + std::to_string(offset + done) + ": " + reason);
    }
    done += static_cast<std::size_t>(got);
  }
}

}  // namespace g3r::io
