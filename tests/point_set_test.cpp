#include "cloud/point_set.h"

#include "cloud/canonical_cloud.h"
#include "cloud/spacing.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <numeric>
#include <utility>
#include <vector>

namespace g3r {
namespace {

PointSet sphere_set(std::size_t count) { return canonical_cloud(shapes::sphere(count).points).set; }

TEST(PointSet, KnowsWhatItsFunctionsWouldFindAnew) {
  const PointSet set = sphere_set(700);
  const std::vector<std::uint32_t> near = Neighbours(set.points()).of_all(kSpacingNeighbours);
  EXPECT_EQ(set.near(), near);
  EXPECT_EQ(set.local_spacing(), local_spacing(set.points()));
  EXPECT_EQ(set.smoothed_spacing(), smoothed_spacing(local_spacing(set.points()), near));
  EXPECT_EQ(set.spacing(), typical_spacing(local_spacing(set.points())));
}

TEST(PointSet, IsOneThingForAllItsCopies) {
  const PointSet set = sphere_set(300);
  const PointSet copy = set;
  EXPECT_EQ(&copy.near(), &set.near());
  EXPECT_EQ(&copy.tree(), &set.tree());
  EXPECT_EQ(copy.points().data(), set.points().data());
}

// Steps take the first k of the 17 nearest for the k nearest: the order must not depend on how many are asked for, not even on a grid,
// where many are as far away as each other.
TEST(PointSet, NearestPointsOfEqualDistanceComeInTheSameOrderHoweverManyAreAskedFor) {
  std::vector<Vec3> grid;
  for (int i = 0; i < 30 * 30; ++i) grid.push_back({0.05 * (i % 30) - 0.7, 0.05 * (i / 30) - 0.7, 0});
  const PointSet set = canonical_cloud(grid).set;
  for (const std::size_t k : {9U, 11U, 12U}) {
    const std::vector<std::uint32_t> fewer = set.tree().of_all(k);
    for (std::size_t i = 0; i < set.size(); ++i) {
      for (std::size_t j = 0; j < k; ++j) ASSERT_EQ(fewer[i * k + j], set.near()[i * set.near_count() + j]) << k << " " << i;
    }
  }
}

TEST(PointSet, OfFewPointsHasFewNear) {
  const PointSet set(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(set.near_count(), 3U);
  EXPECT_EQ(set.near().size(), 9U);
  EXPECT_EQ(PointSet().size(), 0U);
}

}  // namespace
}  // namespace g3r
