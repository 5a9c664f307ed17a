// Kernels where points crowd: as wide as their spacing, so that few points see each other one by one.
#include "orient/crowded.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/constants.h"
#include "cloud/morton.h"
#include "orient/polish.h"
#include "sanitized.h"
#include "shapes.h"
#include "tree/interaction_lists.h"
#include "tree/octree.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace g3r {
namespace {

// A ball of which 45 % of the points are a ball beside it that is 1e-4 times as large.
shapes::Surface ball_and_crowd(std::size_t points) {
  const std::size_t crowd = points * 45 / 100;
  shapes::Surface both = shapes::sphere(points - crowd, 1);
  const shapes::Surface small = shapes::sphere(crowd, 1e-4, {1.5, 0, 0});
  both.points.insert(both.points.end(), small.points.begin(), small.points.end());
  both.normals.insert(both.normals.end(), small.normals.begin(), small.normals.end());
  return both;
}

TEST(Crowded, KernelsFollowTheSpacingThereAndNowhereElse) {
  EXPECT_EQ(narrowing(3), 1);
  EXPECT_EQ(narrowing(kClearlyLess), 1);
  EXPECT_EQ(narrowing(kClearlyLess / 2), kClearlyLess / 2);
  EXPECT_TRUE(narrowed(0.4, {1, 2, kClearlyLess}, 1).uniform());
  EXPECT_EQ(narrowed(0.5, {2, 1, 0.015625}, 1).values, (std::vector<double>{0.5, 0.5, 0.0078125}));
}

TEST(Crowded, KernelsThatHideNoiseFollowItToo) {
  Settings settings;
  settings.spacing = 1;
  EXPECT_EQ(local_widths({0.25, 0.5, 0}, settings, {1, 0.75, 0.125}).values, (std::vector<double>{0.5, 0.5, 0.0625}));
}

TEST(Crowded, NearPairsOfAPointDoNotGrowWithTheCrowd) {
  const auto near_sources = [](std::size_t points, bool is_narrowed) {
    const CanonicalCloud cloud = canonical_cloud(ball_and_crowd(points).points);
    const PointSet& set = cloud.set;
    const double width = 0.4 * set.spacing();
    const Widths widths = is_narrowed ? narrowed(width, set.smoothed_spacing(), set.spacing()) : Widths(width);
    const Octree tree = build_octree(set.points(), morton_codes(set.points()), widths.values, 48);
    const InteractionLists lists = build_interaction_lists(tree, tree, 0.8, 4);
    const auto count = [&](std::size_t leaf) { return static_cast<double>(tree.nodes[tree.leaves[leaf]].count()); };
    double pairs = 0;
    for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
      for (std::size_t k = lists.near_begin[i]; k < lists.near_begin[i + 1]; ++k) pairs += count(i) * count(lists.near[k]);
    }
    return pairs / static_cast<double>(points);
  };
  EXPECT_LT(near_sources(20000, true), 1.5 * near_sources(5000, true));
  EXPECT_GT(near_sources(20000, false), 3 * near_sources(5000, false));
}

TEST(Crowded, ASurfaceOfACrowdHasItsNormalsAndIsClosed) {
  if (kSanitized) GTEST_SKIP() << "a whole solve, whose result is what counts";
  // At random: of points in a spiral any kernel shows the surface.
  shapes::Random random(1);
  shapes::Surface both;
  for (int i = 0; i < 50000; ++i) {
    const Vec3 normal = vector::normalised({random.gaussian(), random.gaussian(), random.gaussian()});
    const bool is_crowd = i % 20 < 9;
    both.points.push_back(vector::add(vector::scale(normal, is_crowd ? 1e-4 : 1), {is_crowd ? 1.5 : 0, 0, 0}));
    both.normals.push_back(normal);
  }
  const Orientation found = orient(both.points);
  EXPECT_TRUE(found.stats.consistent);
  EXPECT_TRUE(found.stats.warnings.empty());
  double sum = 0;  // of 1 - cos
  for (std::size_t i = 0; i < both.points.size(); ++i) sum += 1 - vector::dot(found.normals[i], both.normals[i]);
  EXPECT_LT(sum / static_cast<double>(both.points.size()), 1e-4);
}

}  // namespace
}  // namespace g3r
