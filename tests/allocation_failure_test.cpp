// Orienting and meshing when memory runs out: whichever allocation fails, the error is std::bad_alloc and nothing leaks.
#include <g3r/g3r.h>

#include "counting_allocator.h"
#include "sanitized.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <functional>

namespace g3r {
namespace {

constexpr std::size_t kPoints = 500;
constexpr long kMostAllocations = 10'000'000;     // more are a loop without end
constexpr long kEvery = kSanitized ? 100 : 1000;  // allocations that fail one by one; the later ones are sampled
constexpr long kSparseness = kSanitized ? 8 : 20;

Options options_for(int threads) {
  Options options;
  options.threads = threads;
  return options;
}

// Runs `work` with allocation n failing, for every n below `all` and then for every n about 1/kSparseness above the last, until it needs
// no more than n. One thread: others may keep memory for their next task.
void expect_survives(const std::function<void()>& work, long all) {
  work();  // what is allocated once for the whole program
  const std::size_t before = allocator::live;
  long failures = 0;
  bool finished = false;
  for (long n = 0; !finished && n < kMostAllocations; n += n < all ? 1 : 1 + n / kSparseness) {
    allocator::until_failure = n;
    try {
      work();
      finished = allocator::until_failure >= 0;  // otherwise it did without the memory, as std::stable_sort can
    } catch (const std::bad_alloc&) {
      ++failures;
    }
    allocator::until_failure = -1;
    ASSERT_EQ(allocator::live, before) << n;
  }
  EXPECT_TRUE(finished);
  testing::Test::RecordProperty("failures", static_cast<int>(failures));
  EXPECT_GT(failures, 10);
}

TEST(AllocationFailure, OrientLeaksNothing) {
  const shapes::Surface torus = shapes::torus(kPoints);
  expect_survives([&] { (void)orient(torus.points, options_for(1)); }, kEvery);
}

TEST(AllocationFailure, OrientByThePaperLeaksNothing) {
  const shapes::Surface torus = shapes::torus(kPoints / 5);
  Options options = options_for(1);
  options.preset = Preset::kPaper;
  expect_survives([&] { (void)orient(torus.points, options); }, kEvery);
}

TEST(AllocationFailure, ReconstructLeaksNothing) {
  const shapes::Surface torus = shapes::torus(kPoints);
  MeshOptions mesh;
  mesh.depth = 4;
  mesh.faces = 200;
  expect_survives([&] { (void)reconstruct(torus.points, options_for(1), mesh); }, 0);
}

TEST(AllocationFailure, ReachesTheCallerFromAnyThread) {
  const shapes::Surface torus = shapes::torus(kPoints);
  const std::vector<Vec3> expected = reconstruct(torus.points, options_for(3)).orientation.normals;
  int failures = 0;
  for (long n = 1; n < 5000; n += 1 + n / 10) {
    allocator::until_failure = n;
    try {
      const Reconstruction result = reconstruct(torus.points, options_for(3));
      allocator::until_failure = -1;
      EXPECT_EQ(result.orientation.normals, expected) << n;  // it did without the memory, as std::stable_sort can
    } catch (const std::bad_alloc&) {
      ++failures;
    }
    allocator::until_failure = -1;
  }
  EXPECT_GT(failures, 10);
}

}  // namespace
}  // namespace g3r
