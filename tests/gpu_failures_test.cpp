// What surrounds the kernels, without any device: failing devices, the cache of kernels, the tiles of far pairs.
#include "cloud/morton.h"
#include "cpu/parallel.h"
#include "german_locale.h"
#include "gpu/device.h"
#include "gpu/drivers.h"
#include "gpu/execution.h"
#include "gpu/kernel_cache.h"
#include "gpu/kernel_source.h"
#include "gpu/library.h"
#include "gpu/lists_on_device.h"
#include "shapes.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "sum/device_scope.h"
#include "sum/fast_sum.h"
#include "sum_cases.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#if !defined(G3R_SERIAL) && !defined(__SANITIZE_THREAD__)
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

#include <sys/wait.h>
#include <unistd.h>

namespace g3r {
namespace {

using namespace sum_cases;  // NOLINT(google-build-using-namespace)

// A device that gives `allowed` buffers and starts `launches` kernels before it fails; with 0 it cannot compile. It computes nothing, and
// every double that is read is 1. Counts what is not freed, launches, and the bytes of copies.
class FailingDevice : public gpu::Device {
  static constexpr std::size_t kSmall = 256;  // bytes

 public:
  explicit FailingDevice(std::size_t allowed, std::size_t launches = 0, std::size_t memory = 0)
      : Device(described(launches > 0, memory)), left_(allowed), launches_(launches), compiles_(launches > 0) {}
  ~FailingDevice() override { forget(); }
  FailingDevice(const FailingDevice&) = delete;
  FailingDevice& operator=(const FailingDevice&) = delete;

  void finish() override {}

  std::size_t alive = 0;
  std::size_t launched = 0;
  std::size_t written = 0;
  std::size_t read_back = 0;
  std::set<std::vector<std::uint32_t>> uploaded;  // small arrays

 protected:
  std::unique_ptr<gpu::Buffer> make_buffer(std::size_t bytes) override {
    if (left_ == 0) throw gpu::DeviceError("out of memory");
    --left_;
    return std::make_unique<Counted>(bytes, alive);
  }
  std::unique_ptr<gpu::Staging> make_staging(std::size_t bytes) override { return std::make_unique<HostMemory>(bytes); }
  void start_write(const gpu::Buffer&, std::size_t, gpu::Staging& staging, std::size_t bytes) override {
    written += bytes;
    if (bytes > kSmall) return;
    std::vector<std::uint32_t> numbers(bytes / sizeof(std::uint32_t));
    std::memcpy(numbers.data(), staging.data(), numbers.size() * sizeof numbers[0]);
    uploaded.insert(numbers);
  }
  void start_read(const gpu::Buffer&, std::size_t, gpu::Staging& staging, std::size_t bytes) override {
    EXPECT_TRUE(compiles_) << "nothing was computed";
    const double one = 1;
    for (std::size_t k = 0; k + sizeof one <= bytes; k += sizeof one) std::memcpy(staging.data() + k, &one, sizeof one);
    read_back += bytes;
  }
  void start(gpu::Kernel&, std::size_t, std::size_t, const std::vector<gpu::Argument>&, std::size_t) override {
    if (launches_ == 0) throw gpu::DeviceError("the device was lost");
    --launches_;
    ++launched;
  }
  std::unique_ptr<gpu::Program> compile(const std::string&) override {
    if (!compiles_) throw gpu::DeviceError("the kernels do not compile");
    return std::make_unique<NoProgram>();
  }

 private:
  struct NoProgram : gpu::Program {
    gpu::Kernel nothing{"nothing"};
    gpu::Kernel& kernel(const std::string&) override { return nothing; }
  };
  struct Counted : gpu::Buffer {
    std::size_t& count;
    Counted(std::size_t bytes, std::size_t& c) : Buffer(bytes), count(c) { ++count; }
    ~Counted() override { --count; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
  };
  struct HostMemory : gpu::Staging {
    std::vector<unsigned char> bytes;
    explicit HostMemory(std::size_t size) : bytes(size) { data_ = bytes.data(); }
    void wait() override {}
  };
  static gpu::DeviceInfo described(bool doubles, std::size_t memory) {
    gpu::DeviceInfo info;
    info.name = "Failing";
    info.doubles = doubles;
    info.memory = memory;
    return info;
  }
  std::size_t left_;
  std::size_t launches_;
  bool compiles_;
};

void sleep_some(int i) { std::this_thread::sleep_for(std::chrono::microseconds(100 + i * 7919 % 3000)); }

constexpr std::size_t kPoints = 3000;
constexpr std::size_t kPlenty = 1000;  // buffers; a sum takes fewer

TEST(GpuFailures, TheProcessorTakesOverWithTheSameBytes) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const SumPlan plan = sum_plan(1e-2, kPoints);
  const std::vector<double> expected = FastSum(points, Widths(0.01), plan).winding(eta);
  for (const std::size_t allowed : {std::size_t{0}, std::size_t{1}, std::size_t{9}, std::size_t{20}, kPlenty}) {
    const auto device = std::make_shared<FailingDevice>(allowed);
    SumPlan failing = plan;
    failing.execution = std::make_shared<gpu::Execution>(device, false);
    FastSum sum(points, Widths(0.01), failing);
    EXPECT_EQ(sum.winding(eta), expected);
    EXPECT_EQ(failing.execution->failure(), allowed == kPlenty ? "Failing: the kernels do not compile" : "Failing: out of memory");
    EXPECT_EQ(device->alive, 0U) << "buffers of a device that is no longer used";
    EXPECT_EQ(sum.winding(eta), expected);
  }
}

// A system with another right side, which no device has computed.
class WithRightSide : public LinearSystem {
 public:
  WithRightSide(LinearSystem& system, std::vector<Vec3> right) : system_(system), right_(std::move(right)) {}
  void apply(const std::vector<Vec3>& x, std::vector<Vec3>& product) override { system_.apply(x, product); }
  std::vector<Vec3> right_side() override { return right_; }
  std::unique_ptr<SolveVectors> vectors_elsewhere() override { return system_.vectors_elsewhere(); }

 private:
  LinearSystem& system_;
  std::vector<Vec3> right_;
};

const std::vector<Steps> kFiveSteps{{5, StepKind::kConjugateGradient}};

TEST(GpuFailures, ASolveThatLosesItsVectorsStartsAgainWithTheSameBytes) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const std::vector<Vec3> right = random_vectors(points.size(), 1);
  const SumPlan plan = sum_plan(1e-2, kPoints);
  FastSum processor(points, Widths(0.01), plan);
  EnergySystem reference(processor, 1, 1e-3);
  WithRightSide known(reference, right);
  const IterativeResult expected = solve_iteratively(known, kFiveSteps, 0);
  // Of buffers: none, some of the vectors, all but not the trees, some of the sums. Of launches: in the first product, in the third.
  for (const auto& [allowed, launches] :
       {std::pair<std::size_t, std::size_t>{0, kPlenty}, {3, kPlenty}, {7, kPlenty}, {25, kPlenty}, {kPlenty, 5}, {kPlenty, 70}}) {
    const auto device = std::make_shared<FailingDevice>(allowed, launches);
    SumPlan failing = plan;
    failing.execution = std::make_shared<gpu::Execution>(device, false);
    {
      FastSum sum(points, Widths(0.01), failing);
      EnergySystem energy(sum, 1, 1e-3);
      WithRightSide system(energy, right);
      const IterativeResult result = solve_iteratively(system, kFiveSteps, 0);
      EXPECT_EQ(result.eta, expected.eta) << allowed << ' ' << launches;
      EXPECT_EQ(result.residuals, expected.residuals);
      EXPECT_FALSE(failing.execution->failure().empty());
    }
    EXPECT_EQ(device->alive, 0U);
  }
}

TEST(GpuFailures, ASolveOnARequiredDeviceThatFailsIsUnavailable) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  SumPlan plan = sum_plan(1e-2, kPoints);
  plan.execution = std::make_shared<gpu::Execution>(std::make_shared<FailingDevice>(kPlenty, std::size_t{70}), true);
  FastSum sum(points, Widths(0.01), plan);
  EnergySystem energy(sum, 1, 1e-3);
  WithRightSide system(energy, random_vectors(points.size(), 1));
  try {
    (void)solve_iteratively(system, kFiveSteps, 0);
    ADD_FAILURE() << "no error";
  } catch (const Unavailable& error) {
    EXPECT_NE(std::string(error.what()).find("Failing: the device was lost"), std::string::npos) << error.what();
  }
}

TEST(GpuFailures, ASolveCopiesVectorsOnceAndDotProductsFromThenOn) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const auto copied = [&](int steps) {
    const auto device = std::make_shared<FailingDevice>(kPlenty, kPlenty);
    SumPlan plan = sum_plan(1e-2, kPoints);
    plan.execution = std::make_shared<gpu::Execution>(device, true);
    FastSum sum(points, Widths(0.01), plan);
    EnergySystem energy(sum, 1, 1e-3);
    WithRightSide system(energy, random_vectors(points.size(), 1));
    EXPECT_EQ(solve_iteratively(system, {{steps, StepKind::kConjugateGradient}}, 0).residuals.size(), static_cast<std::size_t>(steps));
    return std::pair(device->written, device->read_back);
  };
  const auto [written, read_back] = copied(1);
  const auto [written_by_more, read_by_more] = copied(4);
  const std::size_t dots = 2 * ((3 * kPoints + gpu::kDotBlock - 1) / gpu::kDotBlock) * sizeof(double);  // of a step
  EXPECT_EQ(written_by_more, written);
  EXPECT_EQ(read_by_more, read_back + 3 * dots);
  EXPECT_LE(read_back, kPoints * sizeof(Vec3) + 2 * dots);
}

TEST(GpuFailures, SourcesAreCopiedOnceForAllTargets) {
  const std::vector<Vec3> points = unit_points(shapes::torus(20'000, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const auto written = [&](std::size_t targets) {
    const auto device = std::make_shared<FailingDevice>(kPlenty, kPlenty);
    SumPlan plan = sum_plan(1e-2, points.size());
    plan.execution = std::make_shared<gpu::Execution>(device, true);
    shapes::Random random(2);
    std::vector<Vec3> queries(targets);
    for (Vec3& q : queries) q = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    (void)FastSum(points, Widths(0.01), plan).winding_at(eta, queries);
    return device->written;
  };
  constexpr std::size_t kAtOnce = 1 << 17;  // targets of FastSum
  EXPECT_LE(written(kAtOnce + 9) - written(kAtOnce), points.size() * 3 * sizeof(float)) << "places or values twice";
}

TEST(GpuFailures, ARequiredDeviceThatFailsIsUnavailable) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kPoints, 0.6, 0.25, 3).points);
  const auto device = std::make_shared<FailingDevice>(std::size_t{5});
  SumPlan plan = sum_plan(1e-2, kPoints);
  plan.execution = std::make_shared<gpu::Execution>(device, true);
  {
    FastSum sum(points, Widths(0.01), plan);
    try {
      (void)sum.winding(random_vectors(points.size(), 1));
      ADD_FAILURE() << "no error";
    } catch (const Unavailable& error) {
      EXPECT_NE(std::string(error.what()).find("Failing: out of memory"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(device->alive, 0U);
}

#if !defined(G3R_SERIAL) && !defined(__SANITIZE_THREAD__)
// In loops of a caller, whose other tasks may want the device that a task has: a thread that took one up would wait for itself.
// ThreadSanitizer cannot see into those loops.
TEST(GpuFailures, WhoHasADeviceAloneTakesUpNothingElse) {
  constexpr int kThreads = 6;  // more than there may be cores: idle ones take up what the others' loops have left
  constexpr int kTasks = 300;
  static thread_local bool has_it = false;
  FailingDevice device(kPlenty);
  std::atomic<int> took_up = 0;
  std::atomic<int> done = 0;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, kThreads);
  tbb::task_arena(kThreads).execute([&] {
    tbb::parallel_for(0, kTasks, [&](int i) {
      took_up += has_it ? 1 : 0;
      if (has_it || i % 3 != 0) return sleep_some(i);
      device.alone([&] {
        has_it = true;
        parallel::for_each(16, [](std::size_t) { sleep_some(0); });
        has_it = false;
        ++done;
      });
    });
  });
  EXPECT_EQ(took_up, 0);
  EXPECT_EQ(done, kTasks / 3);
}
#endif

TEST(GpuFailures, WordsThatNameNoDeviceAreInvalid) {
  const std::vector<Vec3> points = shapes::sphere(100).points;
  Options options;
  for (const char* word : {"cuda", "gpu:", "gpu:x", "gpu:-1", "gpu:1x", "GPU"}) {
    options.device = word;
    EXPECT_THROW((void)orient(points, options), InvalidInput) << word;
  }
  for (const char* word : {"", "auto", "cpu"}) {
    options.device = word;
    EXPECT_EQ(orient(points, options).stats.device, "cpu") << word;
  }
}

TEST(GpuFailures, EveryFarPairIsInOneTileAndTilesDoNotMeetATargetTwice) {
  const std::vector<Vec3> points = unit_points(shapes::torus(20000, 0.6, 0.25, 3).points);
  constexpr std::size_t kChunkNodes = 32;
  const Octree tree = build_octree(points, morton_codes(points), {0.005}, 32);
  const InteractionLists lists = build_interaction_lists(tree, tree, 0.8, 4);
  const M2lMatrices<float> matrices(lists.offsets, {});
  std::vector<std::uint32_t> matrix_of;
  for (std::size_t i = 0; i < lists.offsets.size(); ++i) matrix_of.push_back(static_cast<std::uint32_t>(matrices.index(i)));
  const gpu::TiledPairs tiled = gpu::tile_pairs(lists, tree.nodes.size(), kChunkNodes, matrix_of);
  const gpu::TiledPairs by_one =
      parallel::with_threads(1, [&] { return gpu::tile_pairs(lists, tree.nodes.size(), kChunkNodes, matrix_of); });
  EXPECT_TRUE(by_one.tiles == tiled.tiles && by_one.pairs == tiled.pairs && by_one.chunk_tiles == tiled.chunk_tiles);
  ASSERT_EQ(tiled.pairs.size(), lists.far.size());
  ASSERT_EQ(tiled.chunk_tiles.size(), (tree.nodes.size() + kChunkNodes - 1) / kChunkNodes + 1);
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (const FarPair& pair : lists.far) expected.emplace(pair.target, pair.source);
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  for (std::size_t chunk = 0; chunk + 1 < tiled.chunk_tiles.size(); ++chunk) {
    for (std::uint32_t t = tiled.chunk_tiles[chunk]; t < tiled.chunk_tiles[chunk + 1]; ++t) {
      const auto& tile = tiled.tiles[t];
      EXPECT_LE(tile[2], gpu::kMostTilePairs);
      std::set<std::uint32_t> targets;
      for (std::uint32_t i = tile[1]; i < tile[1] + tile[2]; ++i) {
        EXPECT_EQ(tiled.pairs[i][0] / kChunkNodes, chunk);
        EXPECT_EQ(tiled.pairs[i][2] & gpu::kPositive, tile[3]);
        EXPECT_TRUE(targets.insert(tiled.pairs[i][0]).second);
        found.emplace(tiled.pairs[i][0], tiled.pairs[i][1]);
      }
    }
  }
  EXPECT_EQ(tiled.chunk_tiles.back(), tiled.tiles.size());
  EXPECT_EQ(found, expected);
  EXPECT_LT(tiled.tiles.size(), tiled.pairs.size() / 2) << "tiles do not share matrices";
}

// Leaves of a billion points each, all near to each other: their pairs of a leaf and a point do not fit 32 bits, those of one leaf do.
TEST(GpuFailures, NearPointsOfAllLeavesMayBeMoreThan32BitsCount) {
  constexpr std::uint32_t kLeaves = 3;
  constexpr std::uint32_t kOfLeaf = 1'000'000'000;
  Octree tree;
  InteractionLists lists;
  lists.near_begin.push_back(0);
  tree.nodes.resize(1 + kLeaves);
  tree.nodes[0] = {0, kLeaves * kOfLeaf, 1, kLeaves, 0, 0};
  for (std::uint32_t i = 0; i < kLeaves; ++i) {
    tree.nodes[1 + i] = {
        i * kOfLeaf, (i + 1) * kOfLeaf, 0, 0, 0, 1, {static_cast<std::int32_t>(i % 2), static_cast<std::int32_t>(i / 2), 0}};
    tree.leaves.push_back(1 + i);
    for (std::uint32_t j = 0; j < kLeaves; ++j) lists.near.push_back(j);
    lists.near_begin.push_back(lists.near.size());
  }
  tree.level_begin = {0, 1, 1 + kLeaves};
  FailingDevice device(kPlenty, kPlenty);
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i <= kLeaves * kLeaves; ++i) expected.push_back(i * kOfLeaf);
  const auto there = std::make_shared<gpu::TreeOnDevice>(device, tree);
  gpu::ListsOnDevice<float> on_device(device, tree, tree, there, lists);
  on_device.prepare_near();
  EXPECT_EQ(device.uploaded.count(expected), 1U);
}

TEST(GpuFailures, PartsOfATreeHaveItsLeavesOnceAndAllThatIsAboveThem) {
  const std::vector<Vec3> points = unit_points(shapes::torus(20000, 0.6, 0.25, 3).points);
  constexpr std::size_t kChunkNodes = 4;
  constexpr std::size_t kParts = 3;
  const Octree tree = build_octree(points, morton_codes(points), {0.005}, 32);
  const InteractionLists lists = build_interaction_lists(tree, tree, 0.8, 4);
  const M2lMatrices<float> matrices(lists.offsets, {});
  std::vector<std::uint32_t> matrix_of;
  for (std::size_t i = 0; i < lists.offsets.size(); ++i) matrix_of.push_back(static_cast<std::uint32_t>(matrices.index(i)));
  std::vector<std::uint32_t> leaves;
  std::vector<int> found(tree.nodes.size());
  for (std::size_t p = 0; p < kParts; ++p) {
    const std::size_t first = tree.leaves.size() * p / kParts;
    const gpu::PartOfTree part = gpu::part_of_tree(tree, first, tree.leaves.size() * (p + 1) / kParts);
    std::vector<std::uint32_t> whole(part.tree.nodes.size());  // their numbers in the tree
    for (std::uint32_t i = 0; i < part.number.size(); ++i) {
      if (part.number[i] == gpu::kNotInPart) continue;
      whole[part.number[i]] = i;
      ++found[i];
    }
    EXPECT_TRUE(std::is_sorted(whole.begin(), whole.end()));
    ASSERT_EQ(part.tree.levels(), tree.levels());
    for (std::uint32_t i = 0; i < whole.size(); ++i) {
      EXPECT_EQ(whole[part.tree.nodes[i].parent], tree.nodes[whole[i]].parent);
      EXPECT_EQ(part.tree.nodes[i].begin, tree.nodes[whole[i]].begin);
      const auto level = static_cast<std::size_t>(part.tree.nodes[i].level);
      EXPECT_TRUE(i >= part.tree.level_begin[level] && i < part.tree.level_begin[level + 1]);
    }
    for (const std::uint32_t leaf : part.tree.leaves) leaves.push_back(whole[leaf]);
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
    for (const FarPair& pair : lists.far) {
      if (part.number[pair.target] != gpu::kNotInPart) expected.emplace(pair.target, pair.source);
    }
    std::set<std::pair<std::uint32_t, std::uint32_t>> tiled;
    const gpu::TiledPairs pairs = gpu::tile_pairs(lists, whole.size(), kChunkNodes, matrix_of, part.number);
    for (const auto& pair : pairs.pairs) tiled.emplace(whole[pair[0]], pair[1]);
    EXPECT_EQ(tiled, expected);
    EXPECT_EQ(pairs.pairs.size(), expected.size());
  }
  EXPECT_EQ(leaves, tree.leaves);
  for (const int times : found) EXPECT_GE(times, 1);
}

TEST(GpuFailures, ADeviceThatHoldsTooLittleEvenInPartsIsNotUsed) {
  const std::vector<Vec3> points = unit_points(shapes::torus(20'000, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const SumPlan plan = sum_plan(1e-2, points.size());
  const auto sum_with = [&](std::size_t memory, bool required, std::shared_ptr<FailingDevice>& device, std::string& failure) {
    device = std::make_shared<FailingDevice>(kPlenty, kPlenty, memory);
    SumPlan there = plan;
    there.execution = std::make_shared<gpu::Execution>(device, required);
    FastSum sum(points, Widths(0.01), there);
    std::vector<Vec3> s;
    std::vector<double> w;
    sum.stokes_winding(eta, s, w);
    failure = there.execution->failure();
    return w;
  };
  std::shared_ptr<FailingDevice> device;
  std::string failure;
  (void)sum_with(0, true, device, failure);
  const std::size_t whole = device->take_most_memory();
  const std::size_t launches = device->launched;
  (void)sum_with(whole * 4 / 5, true, device, failure);
  EXPECT_LE(device->take_most_memory(), whole * 4 / 5);
  EXPECT_GT(device->launched, launches) << "not in parts";
  EXPECT_EQ(device->alive, 0U);
  const std::vector<double> expected = FastSum(points, Widths(0.01), plan).winding(eta);
  const std::vector<double> taken_over = sum_with(whole / 4, false, device, failure);
  EXPECT_LE(relative_error(taken_over, expected), 1e-2);
  EXPECT_NE(failure.find("Failing: cannot allocate on the device: out of memory"), std::string::npos) << failure;
  EXPECT_EQ(device->alive, 0U);
  EXPECT_THROW((void)sum_with(whole / 4, true, device, failure), Unavailable);
}

TEST(GpuFailures, TheCacheGivesBackWhatIsWholeAndNothingElse) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "g3r_cache_test";
  std::filesystem::remove_all(folder);
  setenv("XDG_CACHE_HOME", folder.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  const std::vector<unsigned char> binary{1, 2, 3, 0, 255, 10};
  const gpu::KernelCache cache("device, driver, source");
  EXPECT_TRUE(cache.read().empty());
  cache.write(binary);
  EXPECT_EQ(cache.read(), binary);
  EXPECT_EQ(gpu::KernelCache("device, driver, source").read(), binary);
  EXPECT_TRUE(gpu::KernelCache("device, driver, other source").read().empty());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "g3r"), {}), 1) << "unfinished files";
  const auto size = std::filesystem::file_size(cache.file());
  for (const std::uintmax_t left : {std::uintmax_t{0}, std::uintmax_t{5}, size - 1}) {
    std::filesystem::resize_file(cache.file(), left);
    EXPECT_TRUE(cache.read().empty()) << left;
    cache.write(binary);
    EXPECT_EQ(cache.read(), binary);
  }
  {
    std::fstream file(cache.file(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(size) - 1);
    file.put('!');
  }
  EXPECT_TRUE(cache.read().empty());
  std::filesystem::remove_all(folder);
  std::ofstream(folder) << "not a folder";
  cache.write(binary);
  EXPECT_TRUE(cache.read().empty());
  std::filesystem::remove_all(folder);
}

// Programs with windows set the locale of their user.
TEST(GpuFailures, ALocaleWithDecimalCommasChangesNoKernel) {
  gpu::KernelTraits floats, doubles;
  doubles.doubles = true;
  const auto sources = [&] { return std::vector<std::string>{gpu::near_field_source(floats), gpu::near_field_source(doubles)}; };
  const std::vector<std::string> usual = sources();
  const GermanLocale german;
  if (!german.is_there()) GTEST_SKIP() << kNoGermanLocale;
  EXPECT_EQ(sources(), usual);
}

TEST(GpuFailures, AKeptDeviceIsGivenOutOnceAndNotAfterAFork) {
  const auto device = std::make_shared<FailingDevice>(kPlenty);
  gpu::DeviceInfo other = device->info();
  other.handle[1] = 7;
  gpu::keep_device(device);
  EXPECT_EQ(gpu::take_kept_device(other), nullptr);
  EXPECT_EQ(gpu::take_kept_device(device->info()), device);
  EXPECT_EQ(gpu::take_kept_device(device->info()), nullptr) << "it is somebody else's";
  gpu::keep_device(device);
  const pid_t child = fork();
  if (child == 0) _exit(gpu::take_kept_device(device->info()) == nullptr ? 0 : 1);
  int status = 1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0) << "a child has its parent's device";
  EXPECT_EQ(gpu::take_kept_device(device->info()), device);
  EXPECT_EQ(device.use_count(), 1);
}

// The folder of OpenCL's drivers, of files that name one each.
class Vendors {
 public:
  explicit Vendors(const char* variable = "OCL_ICD_VENDORS") : variable_(variable) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    setenv(variable_, folder_.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }
  ~Vendors() {
    unsetenv(variable_);  // NOLINT(concurrency-mt-unsafe)
    std::filesystem::remove_all(folder_);
  }
  Vendors(const Vendors&) = delete;
  Vendors& operator=(const Vendors&) = delete;

  void add(const std::string& file, const std::string& driver) const { std::ofstream(folder_ / file) << driver << '\n'; }

 private:
  const char* variable_;
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "g3r_vendors_test";
};

TEST(GpuFailures, PoclAloneIsSoftwareAndOtherDriversMayBeHardware) {
  const Vendors vendors;
  EXPECT_FALSE(gpu::only_software(gpu::listed_drivers(""))) << "no driver is listed: they may be elsewhere";
  vendors.add("pocl.icd", "libpocl.so.2.10.0");
  vendors.add("pocl-new.icd", "/opt/pocl/lib/libpocl.so.2");
  vendors.add("notes.txt", "libother.so");
  EXPECT_TRUE(gpu::only_software(gpu::listed_drivers("")));
  vendors.add("nvidia.icd", "libnvidia-opencl.so.1");
  EXPECT_FALSE(gpu::only_software(gpu::listed_drivers("")));
}

// A processor's driver beside the loader says nothing of what variables name.
TEST(GpuFailures, DriversAreListedByVariables) {
  const std::filesystem::path prefix = std::filesystem::path(testing::TempDir()) / "g3r_prefix_test";
  const std::string loader = (prefix / "lib/here/libOpenCL.so.1").string();
  const auto software = [&] { return gpu::only_software(gpu::listed_drivers(loader)); };
  std::filesystem::create_directories(prefix / "etc/OpenCL/vendors");
  std::ofstream(prefix / "etc/OpenCL/vendors/pocl.icd") << "libpocl.so.2\n";
  const bool others = !software();  // in the folders above
  {
    const Vendors vendors("OPENCL_VENDOR_PATH");
    vendors.add("nvidia.icd", "libnvidia-opencl.so.1");
    EXPECT_FALSE(software());
  }
  setenv("OCL_ICD_FILENAMES", "libnvidia-opencl.so.1", 1);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_FALSE(software());
  unsetenv("OCL_ICD_FILENAMES");  // NOLINT(concurrency-mt-unsafe)
  std::filesystem::remove_all(prefix);
  if (others) GTEST_SKIP() << "the machine lists other drivers, with which nothing is software alone";
}

TEST(GpuFailures, DriversAreListedBesideTheLoader) {
  const std::filesystem::path prefix = std::filesystem::path(testing::TempDir()) / "g3r_prefix_test";
  const std::filesystem::path folder = prefix / "etc/OpenCL/vendors";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "hardware.icd") << "libhardware.so\n";
  const std::vector<std::string> drivers = gpu::listed_drivers((prefix / "lib/here/libOpenCL.so.1").string());
  EXPECT_NE(std::find(drivers.begin(), drivers.end(), "libhardware.so"), drivers.end());
  std::filesystem::remove_all(prefix);
}

// The loader reads the list once in a process: this is the only test that makes it.
TEST(GpuFailures, AutoDoesNotLoadASoftwareOpenClAndLoadsWhatMayBeHardware) {
  const Vendors vendors;
  const auto loaded = [] { return std::getenv("G3R_FAKE_ICD") != nullptr; };  // NOLINT(concurrency-mt-unsafe)
  vendors.add("software.icd", G3R_FAKE_POCL);
  { const gpu::Scope automatic("auto", 1'000'000); }
  EXPECT_FALSE(loaded());
  vendors.add("hardware.icd", "libg3r_no_such_driver.so");
  { const gpu::Scope automatic("auto", 1'000'000); }
  if (!gpu::Library({"libOpenCL.so.1"}).loaded()) GTEST_SKIP() << "no loader of OpenCL";
  EXPECT_TRUE(loaded());
}

}  // namespace
}  // namespace g3r
