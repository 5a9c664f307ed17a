// The shared library as a guest in other people's processes: loaded and unloaded, after fork, on small stacks, among signals, in another
// locale, from many threads. This program knows the library through dlopen and g3r_c.h only. G3R_SHARED_LIBRARY is its path.
#include <g3r/g3r_c.h>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <clocale>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "german_locale.h"
#include "sanitized.h"
#include "temporary_folder.h"

namespace {

constexpr std::size_t kPoints = 300;
constexpr unsigned kPatience = 120;              // seconds after which a child hangs
constexpr std::size_t kSmallStack = 64UL << 10;  // bytes

class Library {
 public:
  Library() : handle_(dlopen(G3R_SHARED_LIBRARY, RTLD_NOW | RTLD_LOCAL)) {}
  ~Library() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  template <typename Function>
  [[nodiscard]] Function* find(const char* name) const {
    return reinterpret_cast<Function*>(dlsym(handle_, name));
  }
  [[nodiscard]] bool is_loaded() const { return handle_ != nullptr; }

 private:
  void* handle_;
};

std::vector<double> egg() {
  std::vector<double> points;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kPoints;
    const double r = std::sqrt(1 - z * z);
    const double phi = 2.399963229728653 * static_cast<double>(i);
    points.insert(points.end(), {1.5 * r * std::cos(phi), r * std::sin(phi), 0.8 * z});
  }
  return points;
}

// Normals and the vertices of the mesh, one after the other; empty if the call fails.
std::vector<double> reconstruct(const Library& library) {
  const std::vector<double> points = egg();
  std::vector<double> out(points.size());
  g3r_mesh* mesh = nullptr;
  g3r_options options;
  library.find<decltype(g3r_options_init)>("g3r_options_init")(&options, sizeof options);
  options.device = "cpu";
  const auto run = library.find<decltype(g3r_reconstruct)>("g3r_reconstruct");
  if (run(points.data(), kPoints, &options, out.data(), nullptr, nullptr, &mesh) != G3R_OK) return {};
  out.insert(out.end(), mesh->vertices, mesh->vertices + 3 * mesh->vertex_count);
  library.find<decltype(g3r_mesh_free)>("g3r_mesh_free")(mesh);
  return out;
}

// Runs `work` in a forked process: 0 if it says that all is well.
template <typename Work>
int in_child(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(kPatience);
    _exit(work() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

// All tests but the first use one loaded library.
class Guest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    library_ = new Library;
    ASSERT_TRUE(library_->is_loaded()) << dlerror();
    *expected_ = reconstruct(*library_);
    ASSERT_GT(expected_->size(), 3 * kPoints);
  }
  static void TearDownTestSuite() {
    delete library_;
    library_ = nullptr;
  }
  static const Library& library() { return *library_; }
  static const std::vector<double>& expected() { return *expected_; }

 private:
  static inline Library* library_ = nullptr;
  static inline std::vector<double>* const expected_ = new std::vector<double>;
};

// In a child, so that what unloading leaves behind does not reach the tests that follow.
TEST(Host, LoadsAndUnloadsAgainAndAgain) {
  constexpr int kTimes = g3r::kSanitized ? 3 : 8;
  EXPECT_EQ(in_child([] {
              std::vector<double> first;
              for (int i = 0; i < kTimes; ++i) {
                const Library library;
                if (!library.is_loaded()) return false;
                const std::vector<double> result = reconstruct(library);
                if (i == 0) first = result;
                if (result.empty() || result != first) return false;
              }
              return true;
            }),
            0);
}

TEST_F(Guest, WorksOnAfterAFork) {
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(in_child([] { return reconstruct(library()) == expected(); }), 0);
  }
  EXPECT_EQ(reconstruct(library()), expected());
}

TEST_F(Guest, WorksInTheChildOfAChild) {
  EXPECT_EQ(
      in_child([] { return reconstruct(library()) == expected() && in_child([] { return reconstruct(library()) == expected(); }) == 0; }),
      0);
}

TEST_F(Guest, ChildrenEndByExit) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(kPatience);
    std::exit(reconstruct(library()) == expected() ? 0 : 1);  // destructors of what the parent's threads used run here
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(Guest, ThreadsCallAtOnce) {
  constexpr std::size_t kCallers = 4;
  std::vector<std::vector<double>> results(kCallers);
  std::vector<std::thread> callers;
  for (std::size_t i = 0; i < kCallers; ++i) callers.emplace_back([&, i] { results[i] = reconstruct(library()); });
  for (std::thread& caller : callers) caller.join();
  for (const std::vector<double>& result : results) EXPECT_EQ(result, expected());
}

TEST_F(Guest, ASmallStackIsEnough) {
  if (g3r::kSanitized) GTEST_SKIP() << "sanitizers make frames larger";
  std::vector<double> result;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, kSmallStack), 0);
  pthread_t caller{};
  const auto run = [](void* to) -> void* {
    *static_cast<std::vector<double>*>(to) = reconstruct(library());
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&caller, &attributes, run, &result), 0);
  pthread_join(caller, nullptr);
  pthread_attr_destroy(&attributes);
  EXPECT_EQ(result, expected());
}

// Resident bytes of this process.
double resident() {
  std::ifstream in("/proc/self/statm");
  double pages = 0;
  in >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

TEST_F(Guest, ManyCallsTakeNoMoreMemory) {
  if (g3r::kSanitized) GTEST_SKIP() << "sanitizers keep what is freed";
  constexpr std::size_t kFew = 60;   // points: fast
  constexpr int kWarm = 50;          // calls after which nothing grows
  constexpr int kMore = 200;         // of 7 KiB each, if every call lost an arena of threads
  constexpr double kGrowth = 700e3;  // bytes
  const std::vector<double> points = egg();
  std::vector<double> normals(3 * kFew);
  g3r_options options;
  library().find<decltype(g3r_options_init)>("g3r_options_init")(&options, sizeof options);
  options.threads = 2;
  options.device = "cpu";
  const auto orient = library().find<decltype(g3r_orient)>("g3r_orient");
  double before = 0;
  for (int i = 0; i < kWarm + kMore; ++i) {
    if (i == kWarm) before = resident();
    ASSERT_EQ(orient(points.data(), kFew, &options, normals.data(), nullptr, nullptr), G3R_OK);
  }
  EXPECT_LT(resident() - before, kGrowth);
}

volatile std::sig_atomic_t signals = 0;

// A profiler's timer, whose handler does not restart what it interrupts.
TEST_F(Guest, SignalsDoNotDisturb) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) { signals = signals + 1; };
  sigaction(SIGALRM, &action, &before);
  const itimerval often{{0, 500}, {0, 500}};
  setitimer(ITIMER_REAL, &often, nullptr);
  const std::vector<double> result = reconstruct(library());
  const itimerval never{};
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
  EXPECT_EQ(result, expected());
  EXPECT_GT(signals, 0);
}

TEST_F(Guest, LeavesHandlersAndTheLocaleAlone) {
  const g3r::GermanLocale german;
  struct sigaction interrupt {};
  struct sigaction interrupt_after {};
  sigaction(SIGINT, nullptr, &interrupt);
  const std::string locale = std::setlocale(LC_ALL, nullptr);
  EXPECT_EQ(reconstruct(library()), expected());
  EXPECT_EQ(locale, std::setlocale(LC_ALL, nullptr));
  sigaction(SIGINT, nullptr, &interrupt_after);
  EXPECT_EQ(interrupt.sa_handler, interrupt_after.sa_handler);
  if (!german.is_there()) GTEST_SKIP() << g3r::kNoGermanLocale << ": tried in the one that there is";
}

TEST_F(Guest, ALengthWithoutItsUnitIsRefused) {
  const auto orient = library().find<decltype(g3r_orient)>("g3r_orient");
  const auto complaint = library().find<decltype(g3r_last_error)>("g3r_last_error");
  const std::vector<double> points = egg();
  std::vector<double> normals(points.size());
  g3r_options options;
  library().find<decltype(g3r_options_init)>("g3r_options_init")(&options, sizeof options);
  options.device = "cpu";
  options.noise = 0.01;
  EXPECT_EQ(orient(points.data(), kPoints, &options, normals.data(), nullptr, nullptr), G3R_INVALID_INPUT);
  EXPECT_NE(std::string(complaint()).find("noise_unit"), std::string::npos) << complaint();
  options.noise_unit = G3R_UNIT_INPUT;
  EXPECT_EQ(orient(points.data(), kPoints, &options, normals.data(), nullptr, nullptr), G3R_OK) << complaint();
}

TEST_F(Guest, ReportsAreToldByThread) {
  const auto orient = library().find<decltype(g3r_orient)>("g3r_orient");
  const auto report = library().find<decltype(g3r_last_report)>("g3r_last_report");
  ASSERT_NE(report, nullptr);
  const auto tells = [&](const char* words) { return std::string(report()).find(words) != std::string::npos; };
  g3r_options options;
  library().find<decltype(g3r_options_init)>("g3r_options_init")(&options, sizeof options);
  options.device = "cpu";
  std::vector<double> points = egg();
  std::vector<double> normals(points.size());
  ASSERT_EQ(orient(points.data(), kPoints, &options, normals.data(), nullptr, nullptr), G3R_OK);
  EXPECT_TRUE(tells("\"warnings\": []")) << report();
  EXPECT_TRUE(tells("\"mesh\": null")) << report();
  points[0] = NAN;
  ASSERT_EQ(orient(points.data(), kPoints, &options, normals.data(), nullptr, nullptr), G3R_OK);
  EXPECT_TRUE(tells("1 points with a non-finite coordinate were left out")) << report();
  const std::string before = report();
  EXPECT_EQ(orient(points.data(), 2, &options, normals.data(), nullptr, nullptr), G3R_INVALID_INPUT);
  EXPECT_EQ(before, report());
  std::thread([&] { EXPECT_STREQ(report(), ""); }).join();
  ASSERT_FALSE(reconstruct(library()).empty());
  EXPECT_TRUE(tells("\"closed\": true")) << report();
}

TEST_F(Guest, TilesAreFourCalls) {
  const auto init = library().find<decltype(g3r_options_init)>("g3r_options_init");
  const auto plan = library().find<decltype(g3r_tiles_plan)>("g3r_tiles_plan");
  const auto run = library().find<decltype(g3r_tiles_run)>("g3r_tiles_run");
  const auto look = library().find<decltype(g3r_tiles_status)>("g3r_tiles_status");
  const auto merge = library().find<decltype(g3r_tiles_merge)>("g3r_tiles_merge");
  const auto complaint = library().find<decltype(g3r_last_error)>("g3r_last_error");
  const g3r::TemporaryFolder folder;
  constexpr int kTilePoints = 8200;  // few more than tiles take
  {
    std::ofstream file(folder.file("in.xyz"));
    for (int i = 0; i < kTilePoints; ++i) {
      const double z = 1 - (2.0 * i + 1) / kTilePoints;
      const double r = std::sqrt(1 - z * z);
      file << r * std::cos(2.399963 * i) << ' ' << r * std::sin(2.399963 * i) << ' ' << z << '\n';
    }
  }
  const std::string in = folder.file("in.xyz");
  const std::string work = folder.file("work");
  const std::string out = folder.file("out.ply");
  const char* inputs[] = {in.c_str()};
  g3r_options options;
  init(&options, sizeof options);
  options.device = "cpu";
  g3r_tiles_info info{};
  EXPECT_EQ(plan(inputs, 1, work.c_str(), 1, &options, &info), G3R_INVALID_INPUT);  // without its size
  info.size = sizeof info;
  info.doubtful = 7;
  ASSERT_EQ(plan(inputs, 1, work.c_str(), 1, &options, &info), G3R_OK) << complaint();
  EXPECT_EQ(info.points, kTilePoints);
  EXPECT_EQ(info.tiles, 1U);
  EXPECT_EQ(info.done, 0U);
  EXPECT_EQ(info.consistent, 1);
  EXPECT_EQ(info.doubtful, 0);
  EXPECT_EQ(merge(work.c_str(), out.c_str(), nullptr), G3R_INVALID_INPUT);
  EXPECT_EQ(run(work.c_str(), 2, 1, &options, &info), G3R_INVALID_INPUT);
  ASSERT_EQ(run(work.c_str(), 1, 1, &options, nullptr), G3R_OK) << complaint();
  ASSERT_EQ(look(work.c_str(), &info), G3R_OK);
  EXPECT_EQ(info.done, 1U);
  EXPECT_EQ(merge(work.c_str(), folder.file("none/out.ply").c_str(), nullptr), G3R_IO_ERROR);
  ASSERT_EQ(merge(work.c_str(), out.c_str(), nullptr), G3R_OK) << complaint();
  EXPECT_NE(g3r::bytes_of(out).find("element vertex 8200\n"), std::string::npos);
  const std::uint32_t sensors[] = {0};
  options.sensor_of_point = sensors;
  EXPECT_EQ(plan(inputs, 1, work.c_str(), 1, &options, nullptr), G3R_INVALID_INPUT);
  EXPECT_EQ(look(nullptr, &info), G3R_INVALID_INPUT);
}

}  // namespace
