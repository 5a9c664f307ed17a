// Loaded into the program with LD_PRELOAD: lets one chosen system call on files of one folder fail, so that the tests can ask what
// happens when the n-th write, fsync, close or rename goes wrong.
//
//   G3R_FAULT_FOLDER  calls on files opened for writing in this folder count, and renames within it
//   G3R_FAULT_CALL    open, write, fsync, close or rename
//   G3R_FAULT_AT      which of these calls, from 1
//   G3R_FAULT_DO      an errno to fail with, "short" for half a write, "kill" for SIGKILL in place of the call
//   G3R_FAULT_MARK    a file that is created when the fault happens
//
// And lets clocks jump at every call that reads one:
//
//   G3R_FAULT_CLOCK   "set": that of the day goes hours forth and back, as if somebody set it; "asleep": all go on by hours, as after sleep
//
// And lets the system say that other memory is free:
//
//   G3R_FAULT_MEMORY  a file that is read in place of /proc/meminfo
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

namespace {

constexpr std::size_t kMaxFiles = 1024;
constexpr std::time_t kJump = 5 * 3600;  // seconds
std::array<std::atomic<bool>, kMaxFiles> tracked{};
std::atomic<long> calls{0};
std::atomic<long> clock_reads{0};

std::string setting(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

bool in_folder(const char* path) {
  const std::string folder = setting("G3R_FAULT_FOLDER");
  if (folder.empty() || path == nullptr) return false;
  return path[0] != '/' || std::string(path).compare(0, folder.size(), folder) == 0;  // the tests run in the folder
}

bool is_tracked(int file) { return file >= 0 && static_cast<std::size_t>(file) < kMaxFiles && tracked[static_cast<std::size_t>(file)]; }

void track(int file, bool on) {
  if (file >= 0 && static_cast<std::size_t>(file) < kMaxFiles) tracked[static_cast<std::size_t>(file)] = on;
}

/// Whether this call is the chosen one. Does not return if it is to kill.
bool strikes(const char* call) {
  if (setting("G3R_FAULT_CALL") != call || ++calls != std::atol(setting("G3R_FAULT_AT").c_str())) return false;
  const long mark = syscall(SYS_openat, AT_FDCWD, setting("G3R_FAULT_MARK").c_str(), O_CREAT | O_WRONLY, 0644);
  syscall(SYS_close, mark);
  if (setting("G3R_FAULT_DO") == "kill") {
    raise(SIGKILL);
  }
  return true;
}

int fail() {
  errno = std::atoi(setting("G3R_FAULT_DO").c_str());
  return -1;
}

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

int open_file(int folder, const char* path, int flags, mode_t mode) {
  const bool counts = in_folder(path) && (flags & (O_WRONLY | O_RDWR | O_DIRECTORY)) != 0;
  if (counts && (flags & O_CREAT) != 0 && strikes("open")) return fail();
  const auto file = static_cast<int>(syscall(SYS_openat, folder, path, flags, mode));
  track(file, counts && file >= 0);
  return file;
}

// What the streams of the C++ library open their files with.
std::FILE* open_stream(const char* name, const char* path, const char* mode) {
  const std::string memory = setting("G3R_FAULT_MEMORY");
  if (!memory.empty() && std::strcmp(path, "/proc/meminfo") == 0) path = memory.c_str();
  return real<std::FILE* (*)(const char*, const char*)>(name)(path, mode);
}

// What a clock is off by at this reading.
std::time_t jump_of(clockid_t clock) {
  const std::string how = setting("G3R_FAULT_CLOCK");
  if (how == "asleep") return kJump * ++clock_reads;
  return how == "set" && clock == CLOCK_REALTIME ? (++clock_reads % 2 == 0 ? kJump : -kJump) : 0;
}

timespec read_clock(clockid_t clock) {
  timespec now{};
  syscall(SYS_clock_gettime, clock, &now);
  now.tv_sec += jump_of(clock);
  return now;
}

mode_t mode_of(int flags, va_list arguments) { return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0; }

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_file(AT_FDCWD, path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_file(AT_FDCWD, path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_file(folder, path, flags, mode);
}

ssize_t write(int file, const void* data, size_t size) {
  if (is_tracked(file) && strikes("write")) {
    if (setting("G3R_FAULT_DO") != "short") return fail();
    size = (size + 1) / 2;
  }
  return syscall(SYS_write, file, data, size);
}

int fsync(int file) {
  if (is_tracked(file) && strikes("fsync")) return fail();
  return static_cast<int>(syscall(SYS_fsync, file));
}

int close(int file) {
  const bool counts = is_tracked(file);
  track(file, false);
  const auto result = static_cast<int>(syscall(SYS_close, file));
  return counts && strikes("close") ? fail() : result;
}

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  *now = read_clock(clock);
  return 0;
}

int gettimeofday(timeval* now, void*) noexcept {
  const timespec read = read_clock(CLOCK_REALTIME);
  *now = {read.tv_sec, read.tv_nsec / 1000};
  return 0;
}

std::time_t time(std::time_t* now) noexcept {
  const std::time_t read = read_clock(CLOCK_REALTIME).tv_sec;
  if (now != nullptr) *now = read;
  return read;
}

std::FILE* fopen(const char* path, const char* mode) { return open_stream("fopen", path, mode); }
std::FILE* fopen64(const char* path, const char* mode) { return open_stream("fopen64", path, mode); }

int rename(const char* from, const char* to) {
  if (in_folder(to) && strikes("rename")) return fail();
  return real<int (*)(const char*, const char*)>("rename")(from, to);
}

}  // extern "C"
