// Linux, macOS, and what Emscripten offers of POSIX in browsers.
#include "base/platform.h"

#include "base/control_groups.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <new>

#include <fcntl.h>
#include <glob.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#ifdef __APPLE__
#include <mach/mach.h>
#endif

namespace g3r::platform {
namespace {

// Repeats a call that a signal has interrupted.
template <class Call>
auto repeated(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

// Waits for the other end of a named pipe, or a disk on a network.
int opened(const std::string& name, int flags, unsigned permissions = 0) {
  return repeated([&] { return ::open(name.c_str(), flags | O_CLOEXEC, permissions); });
}

void take(const struct stat& from, FileStatus& status) {
  using Kind = FileStatus::Kind;
  status.kind = S_ISREG(from.st_mode) ? Kind::kRegular : S_ISDIR(from.st_mode) ? Kind::kFolder : Kind::kOther;
  status.bytes = static_cast<std::uint64_t>(from.st_size);
  status.permissions = from.st_mode & 07777U;
  status.device = static_cast<std::uint64_t>(from.st_dev);
  status.index = static_cast<std::uint64_t>(from.st_ino);
}

#ifdef __linux__
// Bytes, of a file whose lines have a name, a colon and kilobytes; 0 if none has this name.
double told_by(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(name + ":")) return 1024 * std::strtod(line.c_str() + name.size() + 1, nullptr);
  }
  return 0;
}
#endif

// Of a pattern for glob(), where brackets and backslashes have a meaning of their own.
std::string with_plain_brackets(const std::string& pattern) {
  std::string out;
  for (const char c : pattern) {
    if (c == '[' || c == ']' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::filesystem::path path_of(const std::string& name) { return name; }
std::string name_of(const std::filesystem::path& path) { return path.string(); }

bool get_status(const std::string& name, FileStatus& status) {
  struct stat found {};
  if (::stat(name.c_str(), &found) != 0) return false;
  take(found, status);
  return true;
}

bool get_status(int file, FileStatus& status) {
  struct stat found {};
  if (::fstat(file, &found) != 0) return false;
  take(found, status);
  return true;
}

bool exists(const std::string& name) { return ::access(name.c_str(), F_OK) == 0; }
bool may_read(const std::string& name) { return ::access(name.c_str(), R_OK) == 0; }
bool may_write(const std::string& name) { return ::access(name.c_str(), W_OK) == 0; }
bool may_create_in(const std::string& folder) { return ::access(folder.c_str(), W_OK | X_OK) == 0; }

std::string resolve(const std::string& name) {
  const std::unique_ptr<char, void (*)(void*)> real(::realpath(name.c_str(), nullptr), std::free);
  return real != nullptr ? std::string(real.get()) : name;
}

std::vector<std::string> matching(const std::string& pattern) {
  struct Matches {
    ~Matches() { ::globfree(&found); }
    glob_t found{};
  } matches;
  const int result = ::glob(with_plain_brackets(pattern).c_str(), GLOB_NOSORT, nullptr, &matches.found);
  if (result == GLOB_NOSPACE) throw std::bad_alloc();
  std::vector<std::string> names;
  for (std::size_t i = 0; result == 0 && i < matches.found.gl_pathc; ++i) names.emplace_back(matches.found.gl_pathv[i]);
  return names;
}

int open_to_read(const std::string& name) { return opened(name, O_RDONLY); }
int open_to_write(const std::string& name) { return opened(name, O_WRONLY); }
int standard_input() { return kStandardInput; }
int standard_output() { return kStandardOutput; }
bool close_file(int file) { return ::close(file) == 0; }

std::ptrdiff_t read_some(int file, void* bytes, std::size_t count) {
  return repeated([&] { return ::read(file, bytes, count); });
}

std::ptrdiff_t write_some(int file, const void* bytes, std::size_t count) {
  return repeated([&] { return ::write(file, bytes, count); });
}

std::ptrdiff_t read_at(int file, std::uint64_t offset, void* bytes, std::size_t count) {
  return repeated([&] { return ::pread(file, bytes, count, static_cast<off_t>(offset)); });
}

std::ptrdiff_t write_at(int file, std::uint64_t offset, const void* bytes, std::size_t count) {
  return repeated([&] { return ::pwrite(file, bytes, count, static_cast<off_t>(offset)); });
}

int create_file(const std::string& name, unsigned permissions) {
  return opened(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, permissions & 0777U);
}

bool mark_in_use(int file, const std::string& name) {
  // A file system without locks (ENOTSUP, ENOLCK) is accepted: then leftovers just stay.
  if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  FileStatus opened;
  FileStatus named;
  return get_status(file, opened) && get_status(name, named) && opened.index == named.index && opened.device == named.device;
}

bool remove_if_left_behind(const std::string& name) {
  const int file = opened(name, O_WRONLY | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return false;
  FileStatus status;
  const bool left = get_status(file, status) && status.kind == FileStatus::Kind::kRegular && ::flock(file, LOCK_EX | LOCK_NB) == 0;
  const bool removed = left && ::unlink(name.c_str()) == 0;
  ::close(file);
  return removed;
}

bool set_permissions(int file, unsigned permissions) { return ::fchmod(file, static_cast<mode_t>(permissions)) == 0; }
bool remove_file(const std::string& name) { return ::unlink(name.c_str()) == 0; }

bool sync(int file) {
  return repeated([&] { return ::fsync(file); }) == 0;
}

bool replace(int& /*file*/, const std::string& from, const std::string& to) { return ::rename(from.c_str(), to.c_str()) == 0; }

bool sync_folder(const std::string& folder) {
  const int file = opened(folder, O_RDONLY | O_DIRECTORY);
  if (file < 0) return true;  // a folder that may be written but not read
  const int error = !sync(file) && errno != EINVAL && errno != EROFS ? errno : 0;
  ::close(file);
  errno = error;
  return error == 0;
}

std::size_t peak_memory() {
#ifdef __linux__
  // What getrusage() says includes the memory of the process that this one was started by, until it became this program.
  if (const double peak = told_by("/proc/self/status", "VmHWM"); peak > 0) return static_cast<std::size_t>(peak);
#endif
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
#ifdef __APPLE__
  constexpr std::size_t kUnit = 1;
#else
  constexpr std::size_t kUnit = 1024;
#endif
  return static_cast<std::size_t>(usage.ru_maxrss) * kUnit;
}

void give_back_freed_blocks() {
#ifdef __GLIBC__
  // What is smaller stays in heaps with holes: more than what a part of a sum takes, or each part would be given new pages; less than a
  // field of a large cloud. Left alone, the limit grows with the blocks that are freed, to 32 MiB, and a million points take a fifth more.
  constexpr int kLarge = 2 << 20;
  (void)::mallopt(M_MMAP_THRESHOLD, kLarge);
#endif
}

void give_back_holes() {
#ifdef __GLIBC__
  (void)::malloc_trim(0);
#endif
}

double free_memory() {
#ifdef __APPLE__
  vm_statistics64_data_t pages{};
  mach_msg_type_number_t count = HOST_VM_INFO64_COUNT;
  if (::host_statistics64(::mach_host_self(), HOST_VM_INFO64, reinterpret_cast<host_info64_t>(&pages), &count) != KERN_SUCCESS) return 0;
  const double free = static_cast<double>(pages.free_count) + static_cast<double>(pages.inactive_count);
#else
  const auto free = static_cast<double>(::sysconf(_SC_AVPHYS_PAGES));
#endif
#ifdef __linux__
  // With the caches of files, which it gives up for whoever wants memory: after a large file was read they are most of it.
  if (const double available = told_by("/proc/meminfo", "MemAvailable"); available > 0) return std::min(available, container_memory());
#endif
  return std::min(free * static_cast<double>(::sysconf(_SC_PAGESIZE)), container_memory());
}

std::uint64_t process() { return static_cast<std::uint64_t>(::getpid()); }

std::filesystem::path cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");  // NOLINT(concurrency-mt-unsafe): nothing here sets variables
  if (cache != nullptr && *cache == '/') return cache;
  const char* home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe)
  if (home != nullptr && *home == '/') return std::filesystem::path(home) / ".cache";
  return {};
}

}  // namespace g3r::platform
