#include "io/output_file.h"

#include <g3r/io.h>

#include <cerrno>
#include <cstdlib>
#include <memory>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace g3r::io {

namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 16;  // Bytes that are written at once.
constexpr std::size_t kLongestStem = 200;              // A name may have 255 bytes; the rest is for what makes it temporary.
constexpr int kAttempts = 100;                         // So many writers of one file at the same time find a name each.

// The path with links resolved, or the path itself if it does not exist.
std::string resolve(const std::string& path) {
  const std::unique_ptr<char, void (*)(void*)> real(::realpath(path.c_str(), nullptr), std::free);
  return real != nullptr ? std::string(real.get()) : path;
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

std::string temporary_name(const std::string& target, int attempt) {
  const std::size_t slash = target.find_last_of('/');
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  return target.substr(0, begin) + "." + target.substr(begin, kLongestStem) + (attempt == 0 ? "" : '-' + std::to_string(attempt)) +
         ".g3r.tmp";
}

}  // namespace

OutputFile::OutputFile(const std::string& path, const std::atomic<bool>* cancel) : path_(path), target_(path), cancel_(cancel) {
  buffer_.reserve(kBuffer);
  if (path == "-") {
    path_ = "standard output";
    fd_ = STDOUT_FILENO;
    return;
  }
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (!exists && errno != ENOENT) fail(true, errno);
  if (exists && S_ISDIR(status.st_mode)) fail(true, EISDIR);
  if (exists && !S_ISREG(status.st_mode)) {
    fd_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd_ < 0) fail(true, errno);
    return;
  }
  if (exists && ::access(path.c_str(), W_OK) != 0) fail(true, errno);
  target_ = resolve(path);
  create_temporary(exists ? status.st_mode & 07777U : 0666U, exists);
}

void OutputFile::create_temporary(unsigned mode, bool keep_mode) {
  for (int attempt = 0; attempt < kAttempts;) {
    temporary_ = temporary_name(target_, attempt);
    fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode & 0777U);
    const int error = errno;
    if (fd_ >= 0) {
      if (lock_temporary()) {
        if (keep_mode && ::fchmod(fd_, mode) != 0) fail(true, errno);
        return;
      }
      ::close(fd_);  // another process took it for a leftover
      fd_ = -1;
      ++attempt;
      continue;
    }
    if (error != EEXIST) {
      temporary_.clear();
      fail(true, error);
    }
    // Someone's: alive if locked, else left behind by a killed process.
    const int old = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    struct stat status {};
    const bool stale = old >= 0 && ::fstat(old, &status) == 0 && S_ISREG(status.st_mode) && ::flock(old, LOCK_EX | LOCK_NB) == 0;
    if (!stale || ::unlink(temporary_.c_str()) != 0) ++attempt;
    if (old >= 0) ::close(old);
  }
  temporary_.clear();
  fail(true, EEXIST);
}

// Locks the new temporary file; false if it was removed in between.
bool OutputFile::lock_temporary() {
  struct stat opened {};
  struct stat named {};
  // A file system without locks (ENOTSUP, ENOLCK) is accepted: then leftovers just stay.
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  return ::fstat(fd_, &opened) == 0 && ::stat(temporary_.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

OutputFile::~OutputFile() {
  if (fd_ > STDOUT_FILENO) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(const void* bytes, std::size_t size) {
  buffer_.append(static_cast<const char*>(bytes), size);
  if (buffer_.size() >= kBuffer) flush();
}

void OutputFile::flush() {
  if (cancel_ != nullptr && *cancel_) throw Cancelled();
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t written = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0) {
      if (errno == EINTR) continue;
      fail(false, errno);
    }
    done += static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void OutputFile::overwrite(std::size_t offset, std::string_view bytes) {
  flush();
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::pwrite(fd_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (written < 0) {
      if (errno == EINTR) continue;
      fail(false, errno);
    }
    done += static_cast<std::size_t>(written);
  }
}

void OutputFile::commit() {
  flush();
  if (temporary_.empty()) {
    if (fd_ > STDOUT_FILENO) {
      const int fd = std::exchange(fd_, -1);
      if (::close(fd) != 0) fail(false, errno);
    }
    return;
  }
  while (::fsync(fd_) != 0) {
    if (errno != EINTR) fail(false, errno);
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(false, errno);
  temporary_.clear();
  const int fd = std::exchange(fd_, -1);
  if (::close(fd) != 0) fail(false, errno);
  const int folder = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;  // a folder that may be written but not read: the rename stands
  const int error = ::fsync(folder) != 0 && errno != EINVAL && errno != EROFS ? errno : 0;
  ::close(folder);
  if (error != 0) fail(false, error);
}

void OutputFile::fail(bool creating, int error) const {
  const std::string reason = creating && error == ENOENT ? "there is no such folder" : std::generic_category().message(error);
  throw IoError(creating ? IoError::Kind::kCannotCreate : IoError::Kind::kFailed,
                escape_text(path_) + ": cannot " + (creating ? "create" : "write") + ": " + reason);
}

void check_creatable(const std::string& path) { OutputFile probe(path); }

}  // namespace g3r::io
