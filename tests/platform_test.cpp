// What the library asks of the operating system, the same on all of them: names of files in UTF-8, files that are replaced at once,
// patterns.
#include "base/platform.h"

#include "base/control_groups.h"
#include "io/output_file.h"
#include "io/source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "temporary_folder.h"

#ifndef _WIN32
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/time.h>
#endif

namespace g3r {
namespace {

using platform::FileStatus;

// "Pünktchen 点.xyz": two and three bytes a character.
const std::string kForeign = "P\xC3\xBCnktchen \xE7\x82\xB9.xyz";

void write_whole(const std::string& path, const std::string& text) {
  io::OutputFile file(path);
  file.write(text);
  file.commit();
}

TEST(Platform, NamesOfFilesAreUtf8) {
  const TemporaryFolder folder;
  const std::string path = folder.file(kForeign);
  write_whole(path, "0 0 0\n");
  EXPECT_EQ(platform::name_of(platform::path_of(path).filename()), kForeign);
  EXPECT_TRUE(std::filesystem::exists(platform::path_of(path)));
  EXPECT_EQ(io::read_bytes(path), "0 0 0\n");
  EXPECT_EQ(platform::matching(folder.file("P*.xyz")).size(), 1U);
}

TEST(Platform, BytesAreWrittenAsTheyAre) {
  const TemporaryFolder folder;
  write_whole(folder.file("a.txt"), "1\r\n2\n\x1A 3");
  EXPECT_EQ(io::read_bytes(folder.file("a.txt")), "1\r\n2\n\x1A 3");
}

// Windows may refuse while others have the file open.
TEST(Platform, AFileThatIsReadIsReplacedOrStays) {
  const TemporaryFolder folder;
  write_whole(folder.file("a.txt"), "old");
  const int reader = platform::open_to_read(folder.file("a.txt"));
  std::string expected = "new";
  try {
    write_whole(folder.file("a.txt"), "new");
  } catch (const IoError&) {
    expected = "old";
  }
  platform::close_file(reader);
  EXPECT_EQ(io::read_bytes(folder.file("a.txt")), expected);
#ifndef _WIN32
  EXPECT_EQ(expected, "new");
#endif
}

TEST(Platform, AFileInUseIsNotTakenForLeftBehind) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.tmp");
  const int file = platform::create_file(path, 0666);
  ASSERT_GE(file, 0);
  EXPECT_TRUE(platform::mark_in_use(file, path));
  EXPECT_FALSE(platform::remove_if_left_behind(path));
  EXPECT_LT(platform::create_file(path, 0666), 0);
  EXPECT_EQ(errno, EEXIST);
  platform::close_file(file);
  EXPECT_TRUE(platform::remove_if_left_behind(path));
  EXPECT_FALSE(platform::exists(path));
}

#ifndef _WIN32
std::string pipe_name;
volatile std::sig_atomic_t signals = 0;

// A profiler's timer, whose handler does not restart what it interrupts, while nobody has opened the other end of a pipe.
TEST(Platform, OpeningGoesOnAfterSignals) {
  const TemporaryFolder folder;
  pipe_name = folder.file("pipe");
  ASSERT_EQ(::mkfifo(pipe_name.c_str(), 0600), 0);
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) {
    signals = signals + 1;
    if (signals == 3) (void)::open(pipe_name.c_str(), O_RDWR | O_NONBLOCK);
  };
  ::sigaction(SIGALRM, &action, &before);
  const itimerval often{{0, 2000}, {0, 2000}};
  ::setitimer(ITIMER_REAL, &often, nullptr);
  const int file = platform::open_to_read(pipe_name);
  const itimerval never{};
  ::setitimer(ITIMER_REAL, &never, nullptr);
  ::sigaction(SIGALRM, &before, nullptr);
  EXPECT_GE(file, 0) << std::strerror(errno);
  EXPECT_GE(signals, 3);
  platform::close_file(file);
}
#endif

TEST(Platform, BytesAreReadAndWrittenAtAPlace) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  const int file = platform::create_file(path, 0666);
  ASSERT_GE(file, 0);
  EXPECT_EQ(platform::write_some(file, "abcdef", 6), 6);
  EXPECT_EQ(platform::write_at(file, 2, "XY", 2), 2);
  EXPECT_EQ(platform::write_some(file, "gh", 2), 2);  // where it had ended
  EXPECT_TRUE(platform::sync(file));
  platform::close_file(file);
  const int reader = platform::open_to_read(path);
  std::string text(4, ' ');
  EXPECT_EQ(platform::read_at(reader, 1, text.data(), 4), 4);
  EXPECT_EQ(text, "bXYe");
  EXPECT_EQ(platform::read_at(reader, 8, text.data(), 4), 0);  // the end
  platform::close_file(reader);
  EXPECT_EQ(io::read_bytes(path), "abXYefgh");
}

TEST(Platform, PatternsMatchInEveryPart) {
  const TemporaryFolder folder;
  for (const char* name : {"a1", "a2", "b1"}) {
    std::filesystem::create_directory(folder.file(name));
    write_bytes(folder.file(name) + "/tile_10.las", "");
    write_bytes(folder.file(name) + "/tile_2.las", "");
  }
  EXPECT_EQ(platform::matching(folder.file("a*/tile_??.las")).size(), 2U);
  EXPECT_EQ(platform::matching(folder.file("*/tile*2*.las")).size(), 3U);
  EXPECT_EQ(platform::matching(folder.file("a1/*.l*s")).size(), 2U);
  EXPECT_TRUE(platform::matching(folder.file("c*/tile_2.las")).empty());
}

// Of the characters of names only * and ? stand for others.
TEST(Platform, BracketsOfPatternsAreThemselves) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("scan [2]"));
  std::filesystem::create_directory(folder.file("scan 2"));
  for (const char* name : {"scan [2]/a[1].las", "scan [2]/b].las", "scan 2/a1.las"}) write_bytes(folder.file(name), "");
  const auto found = [&](const char* pattern) {  // from the folder on, with / wherever it runs
    std::vector<std::string> names;
    for (const std::string& name : platform::matching(folder.file(pattern))) {
      names.push_back(std::filesystem::path(name).lexically_relative(folder.file(".")).generic_string());
    }
    std::sort(names.begin(), names.end());
    return names;
  };
  EXPECT_EQ(found("scan [2]/*.las"), (std::vector<std::string>{"scan [2]/a[1].las", "scan [2]/b].las"}));
  EXPECT_EQ(found("scan*/a[1].las"), std::vector<std::string>{"scan [2]/a[1].las"});
  EXPECT_EQ(found("sc?n [2]/?[1].*"), std::vector<std::string>{"scan [2]/a[1].las"});
#ifndef _WIN32
  write_bytes(folder.file("c\\*.las"), "");
  EXPECT_EQ(found("c\\*.l?s"), std::vector<std::string>{"c\\*.las"});
#endif
}

TEST(Platform, StatusTellsFilesFoldersAndWhatIsTheSame) {
  const TemporaryFolder folder;
  write_bytes(folder.file("a"), "123");
  write_bytes(folder.file("b"), "123");
  FileStatus a;
  FileStatus again;
  FileStatus b;
  ASSERT_TRUE(platform::get_status(folder.file("a"), a) && platform::get_status(folder.file("./a"), again));
  ASSERT_TRUE(platform::get_status(folder.file("b"), b));
  EXPECT_EQ(a.kind, FileStatus::Kind::kRegular);
  EXPECT_EQ(a.bytes, 3U);
  EXPECT_TRUE(a.device == again.device && a.index == again.index);
  EXPECT_FALSE(a.device == b.device && a.index == b.index);
  ASSERT_TRUE(platform::get_status(folder.file("."), b));
  EXPECT_EQ(b.kind, FileStatus::Kind::kFolder);
  EXPECT_FALSE(platform::get_status(folder.file("c"), b));
  EXPECT_EQ(errno, ENOENT);
}

TEST(Platform, MemoryIsTold) {
  EXPECT_GT(platform::peak_memory(), std::size_t{1} << 20);
  EXPECT_LT(platform::peak_memory(), std::size_t{1} << 32);
  EXPECT_GT(platform::free_memory(), 1 << 20);
  EXPECT_GT(platform::share_of_free_memory(0.75), std::size_t{1} << 19U);
  EXPECT_EQ(platform::share_of_free_memory(0), 1U);  // nothing is left, which is no limit only where it is 0
}

#ifdef __linux__
double available_memory() {
  std::ifstream in("/proc/meminfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("MemAvailable:")) return 1024 * std::stod(line.substr(13));
  }
  return 0;
}

// Caches of files count as free: after a large file was read they are most of the memory.
TEST(Platform, FreeMemoryIsWhatTheSystemCanGive) {
  constexpr double kOfOthers = 256 << 20;  // what other processes take or give back meanwhile
  const double before = available_memory();
  const double free = platform::free_memory();
  const double after = available_memory();
  if (free == platform::container_memory()) GTEST_SKIP() << "the container leaves less";
  EXPECT_GE(free, std::min(before, after) - kOfOthers);
  EXPECT_LE(free, std::max(before, after) + kOfOthers);
}
#endif

// Both versions of control groups; of all limits around a process the one that leaves least holds, and cached files count as free.
TEST(Platform, LimitsOfContainersAreSeen) {
  const TemporaryFolder folder;
  const auto group = [&](const std::string& name) { std::filesystem::create_directories(folder.file(name)); };
  group("memory/job/step");
  group("job/step");
  const std::string root = folder.file("");
  EXPECT_TRUE(std::isinf(platform::memory_left_by_groups("4:memory:/job/step\n0::/job/step\n", root)));
  write_whole(folder.file("memory/job/memory.limit_in_bytes"), "9223372036854771712\n");  // none
  write_whole(folder.file("memory/job/memory.usage_in_bytes"), "600000\n");
  EXPECT_TRUE(std::isinf(platform::memory_left_by_groups("4:memory:/job\n", root)));
  write_whole(folder.file("memory/job/memory.limit_in_bytes"), "1000000\n");
  write_whole(folder.file("memory/job/memory.stat"), "cache 9\ninactive_file 1\ntotal_inactive_file 5000\n");
  EXPECT_EQ(platform::memory_left_by_groups("5:cpu,memory:/job/step\n0::/\n", root), 405000);
  EXPECT_TRUE(std::isinf(platform::memory_left_by_groups("5:cpu:/job/step\n", root)));
  write_whole(folder.file("job/step/memory.max"), "max\n");
  write_whole(folder.file("job/step/memory.current"), "70000\n");
  EXPECT_TRUE(std::isinf(platform::memory_left_by_groups("0::/job/step\n", root)));
  write_whole(folder.file("job/step/memory.max"), "100000\n");
  write_whole(folder.file("job/step/memory.stat"), "inactive_file 1000\n");
  EXPECT_EQ(platform::memory_left_by_groups("4:memory:/job\n0::/job/step\n", root), 31000);
  // A container sees itself as the root, and may be told the name that it has outside.
  write_whole(folder.file("memory.max"), "500\n");
  write_whole(folder.file("memory.current"), "600\n");
  EXPECT_EQ(platform::memory_left_by_groups("0::/\n", root), 0);
  EXPECT_EQ(platform::memory_left_by_groups("0::/outside/of/it\n", root), 0);
  for (const char* garbage : {"", "\n", "0\n", "0:memory\n", "4:memory:job\n"})
    EXPECT_TRUE(std::isinf(platform::memory_left_by_groups(garbage, root))) << garbage;
}

}  // namespace
}  // namespace g3r
