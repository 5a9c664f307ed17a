// Writes under failing system calls and SIGKILL: the old file is intact or the new one is whole. The system calls that the writer makes are
// replaced in this program.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <random>

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io_samples.h"

namespace {

enum class Fault { kNone, kError, kShortThenError, kInterrupted, kKillBefore, kKillAfter };

Fault g_fault = Fault::kNone;
int g_countdown = 0;  // calls before the fault
int g_calls = 0;
int g_error = EIO;

// Whether this call is the one that fails; counts it.
bool is_struck() { return ++g_calls, g_fault != Fault::kNone && g_countdown-- == 0; }

template <class Call>
auto strike(const Call& call) -> decltype(call()) {
  if (!is_struck()) return call();
  if (g_fault == Fault::kKillBefore) ::raise(SIGKILL);
  if (g_fault == Fault::kKillAfter) {
    call();
    ::raise(SIGKILL);
  }
  errno = g_fault == Fault::kInterrupted ? EINTR : g_error;
  return -1;
}

}  // namespace

extern "C" {
ssize_t write(int fd, const void* bytes, size_t size) {
  const auto real = [&](size_t count) { return static_cast<ssize_t>(syscall(SYS_write, fd, bytes, count)); };
  if (fd <= 2) return real(size);  // gtest's own
  if (g_fault == Fault::kShortThenError && g_countdown == 0 && size > 1) {
    g_fault = Fault::kError;  // the next call fails
    ++g_calls;
    return real(size / 2);
  }
  return strike([&] { return real(size); });
}
int fsync(int fd) {
  return strike([&] { return static_cast<int>(syscall(SYS_fsync, fd)); });
}
int rename(const char* from, const char* to) {
  return strike([&] { return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0)); });
}
}

namespace g3r {
namespace {

using samples::Folder;
using samples::slurp;
using samples::spill;

constexpr char kOld[] = "the old file";

void write_big(const std::string& path) { write_cloud(path, samples::helix(6000), nullptr, nullptr); }

std::string big_bytes() {
  const Folder folder;
  write_big(folder.path("a.ply"));
  return slurp(folder.path("a.ply"));
}

int count_calls() {
  const Folder folder;
  g_calls = 0;
  write_big(folder.path("a.ply"));
  return g_calls;
}

TEST(Faults, EveryFailingCallIsAnIoErrorAndTheOldFileIsIntact) {
  const std::string whole = big_bytes();
  const int calls = count_calls();
  ASSERT_GE(calls, 6);  // several writes, fsync, rename, fsync of the folder
  RecordProperty("calls", calls);
  for (const int error : {ENOSPC, EIO, EDQUOT, EFBIG}) {
    for (const Fault fault : {Fault::kError, Fault::kShortThenError}) {
      for (int n = 0; n < calls; ++n) {
        const Folder folder;
        spill(folder.path("a.ply"), kOld);
        g_error = error;
        g_countdown = n;
        g_fault = fault;
        bool failed = false;
        try {
          write_big(folder.path("a.ply"));
        } catch (const IoError& caught) {
          failed = true;
          EXPECT_EQ(caught.kind(), IoError::Kind::kFailed);
          EXPECT_NE(std::string(caught.what()).find("a.ply: cannot write: "), std::string::npos) << caught.what();
        }
        g_fault = Fault::kNone;
        EXPECT_TRUE(failed || fault == Fault::kShortThenError) << n;
        const std::string now = slurp(folder.path("a.ply"));
        EXPECT_TRUE(now == kOld || now == whole) << n;
        EXPECT_TRUE(failed || now == whole) << n;
        if (n + 1 < calls && failed) {
          EXPECT_EQ(now, kOld) << n;  // only the last call comes after the rename
        }
        EXPECT_EQ(folder.files(), 1U) << n;
      }
    }
  }
}

TEST(Faults, AnInterruptedCallIsRepeated) {
  const std::string whole = big_bytes();
  for (int n = 0; n + 3 < count_calls(); ++n) {  // writes
    const Folder folder;
    g_countdown = n;
    g_fault = Fault::kInterrupted;
    EXPECT_NO_THROW(write_big(folder.path("a.ply")));
    g_fault = Fault::kNone;
    EXPECT_EQ(slurp(folder.path("a.ply")), whole);
  }
}

// Runs write_big() in a child that dies; then the file must be the old or the new one, and the next write must tidy up.
void expect_survived(const Folder& folder, const std::string& whole, pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  const std::string now = slurp(folder.path("a.ply"));
  EXPECT_TRUE(now == kOld || now == whole);
  EXPECT_LE(folder.files(), 2U);
}

TEST(Kill, AtEveryCallTheFileIsTheOldOrTheNewOne) {
  const std::string whole = big_bytes();
  const int calls = count_calls();
  const Folder folder;
  for (const Fault fault : {Fault::kKillBefore, Fault::kKillAfter}) {
    for (int n = 0; n < calls; ++n) {
      spill(folder.path("a.ply"), kOld);
      const pid_t child = ::fork();
      if (child == 0) {
        g_countdown = n;
        g_fault = fault;
        write_big(folder.path("a.ply"));
        ::_exit(0);
      }
      expect_survived(folder, whole, child);
    }
  }
  write_big(folder.path("a.ply"));
  EXPECT_EQ(folder.files(), 1U);  // what the killed left behind is gone
}

TEST(Kill, AtRandomMomentsTheFileIsTheOldOrTheNewOne) {
  constexpr int kKills = 200;
  const std::string whole = big_bytes();
  const auto begin = std::chrono::steady_clock::now();
  count_calls();
  const auto one_write = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begin);
  std::mt19937 random(1);
  std::uniform_int_distribution<long> wait(0, 2 * static_cast<long>(one_write.count()));
  const Folder folder;
  for (int i = 0; i < kKills; ++i) {
    spill(folder.path("a.ply"), kOld);
    const pid_t child = ::fork();
    if (child == 0) {
      write_big(folder.path("a.ply"));
      ::_exit(0);
    }
    ::usleep(static_cast<useconds_t>(wait(random)));
    ::kill(child, SIGKILL);
    expect_survived(folder, whole, child);
  }
  write_big(folder.path("a.ply"));
  EXPECT_EQ(folder.files(), 1U);
}

}  // namespace
}  // namespace g3r
