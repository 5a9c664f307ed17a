#include "io/output_file.h"

#include "base/platform.h"

#include <g3r/io.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace g3r::io {

namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 16;  // Bytes that are written at once.
constexpr std::size_t kLongestStem = 200;              // A name may have 255 bytes; the rest is for what makes it temporary.
constexpr int kAttempts = 100;                         // So many writers of one file at the same time find a name each.

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.find_last_of(platform::kSeparators);
  return slash == std::string::npos ? "." : slash == 0 ? path.substr(0, 1) : path.substr(0, slash);
}

std::string temporary_name(const std::string& target, int attempt) {
  const std::size_t slash = target.find_last_of(platform::kSeparators);
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  return target.substr(0, begin) + "." + target.substr(begin, kLongestStem) + (attempt == 0 ? "" : '-' + std::to_string(attempt)) +
         ".g3r.tmp";
}

}  // namespace

OutputFile::OutputFile(const std::string& path, const std::atomic<bool>* cancel) : path_(path), target_(path), cancel_(cancel) {
  buffer_.reserve(kBuffer);
  if (path == "-") {
    path_ = "standard output";
    fd_ = platform::standard_output();
    return;
  }
  using Kind = platform::FileStatus::Kind;
  platform::FileStatus status;
  const bool exists = platform::get_status(path, status);
  if (!exists && errno != ENOENT) fail(true, errno);
  if (exists && status.kind == Kind::kFolder) fail(true, EISDIR);
  if (exists && status.kind == Kind::kOther) {
    fd_ = platform::open_to_write(path);
    if (fd_ < 0) fail(true, errno);
    return;
  }
  if (exists && !platform::may_write(path)) fail(true, errno);
  target_ = platform::resolve(path);
  create_temporary(exists ? status.permissions : 0666U, exists);
}

void OutputFile::create_temporary(unsigned mode, bool keep_mode) {
  for (int attempt = 0; attempt < kAttempts;) {
    temporary_ = temporary_name(target_, attempt);
    fd_ = platform::create_file(temporary_, mode);
    const int error = errno;
    if (fd_ >= 0) {
      if (platform::mark_in_use(fd_, temporary_)) {
        if (keep_mode && !platform::set_permissions(fd_, mode)) fail(true, errno);
        return;
      }
      platform::close_file(fd_);  // another process took it for a leftover
      fd_ = -1;
      ++attempt;
      continue;
    }
    if (error != EEXIST) {
      temporary_.clear();
      fail(true, error);
    }
    // Someone's, or left behind by a killed process.
    if (!platform::remove_if_left_behind(temporary_)) ++attempt;
  }
  temporary_.clear();
  fail(true, EEXIST);
}

OutputFile::~OutputFile() {
  if (fd_ > platform::kStandardOutput) platform::close_file(fd_);
  if (!temporary_.empty()) platform::remove_file(temporary_);
}

void OutputFile::write(const void* bytes, std::size_t size) {
  buffer_.append(static_cast<const char*>(bytes), size);
  if (buffer_.size() >= kBuffer) flush();
}

void OutputFile::flush() {
  if (cancel_ != nullptr && *cancel_) throw Cancelled();
  for (std::size_t done = 0; done < buffer_.size();) {
    const std::ptrdiff_t written = platform::write_some(fd_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0) fail(false, errno);
    done += static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void OutputFile::overwrite(std::size_t offset, std::string_view bytes) {
  flush();
  for (std::size_t done = 0; done < bytes.size();) {
    const std::ptrdiff_t written = platform::write_at(fd_, offset + done, bytes.data() + done, bytes.size() - done);
    if (written < 0) fail(false, errno);
    done += static_cast<std::size_t>(written);
  }
}

void OutputFile::commit() {
  flush();
  if (temporary_.empty()) {
    if (fd_ > platform::kStandardOutput && !platform::close_file(std::exchange(fd_, -1))) fail(false, errno);
    return;
  }
  const std::string folder = folder_of(target_);  // before the file is in place: from then on nothing may fail for want of memory
  if (!platform::sync(fd_) || !platform::replace(fd_, temporary_, target_)) fail(false, errno);
  temporary_.clear();
  if (fd_ >= 0 && !platform::close_file(std::exchange(fd_, -1))) fail(false, errno);
  if (!platform::sync_folder(folder)) fail(false, errno);
}

void OutputFile::fail(bool creating, int error) const {
  const std::string reason = creating && error == ENOENT ? "there is no such folder" : std::generic_category().message(error);
  throw IoError(creating ? IoError::Kind::kCannotCreate : IoError::Kind::kFailed,
                escape_text(path_) + ": cannot " + (creating ? "create" : "write") + ": " + reason);
}

bool same_file(const std::string& a, const std::string& b) {
  if (a.empty() || a == "-" || b.empty() || b == "-") return false;
  std::error_code ignored;
  const auto place = [&](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(platform::path_of(path), ignored), ignored);
  };
  return place(a) == place(b) || std::filesystem::equivalent(platform::path_of(a), platform::path_of(b), ignored);
}

void check_creatable(const std::string& path) { OutputFile probe(path); }

}  // namespace g3r::io
