// A maximal Poisson disk sample keeps its points apart and covers all others.
#include "cloud/disk_sample.h"

#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cloud/some_places.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

TEST(DiskSample, IsApartAndNearEveryPoint) {
  const std::vector<Vec3> points = shapes::torus(4000, 0.6, 0.25, 5).points;
  for (const double distance : {0.02, 0.1, 0.7}) {
    const std::vector<Vec3> sample = disk_sample(points, distance);
    const Neighbours tree(sample);
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (const Vec3& p : sample) {
      tree.nearest(p, 2, index, squared);  // the point itself, and the next one
      ASSERT_EQ(squared.size(), 2U);
      EXPECT_GE(squared[1], distance * distance) << distance;
    }
    for (const Vec3& p : points) EXPECT_TRUE(tree.any_within(p, distance)) << distance;
  }
}

TEST(DiskSample, TakesTheFirstOfPointsAtOnePlace) {
  const std::vector<Vec3> points{{0, 0, 0}, {0.9, 0, 0}, {1.1, 0, 0}, {-5, 0, 0}, {1.1, 0.5, 0}};
  EXPECT_EQ(disk_sample(points, 1), (std::vector<Vec3>{{0, 0, 0}, {1.1, 0, 0}, {-5, 0, 0}}));
}

TEST(SomePlaces, AreAsManyAsIsAskedForAndEvenlyFar) {
  for (const std::size_t total : {1U, 7U, 499U, 500U, 501U, 999U, 1000U, 1001U, 12345U}) {
    const SomePlaces least = SomePlaces::at_least(500, total), most = SomePlaces::at_most(500, total);
    EXPECT_GE(least.size(), std::min<std::size_t>(500, total)) << total;
    EXPECT_LE(least.size(), 1000U) << total;
    EXPECT_LE(most.size(), 500U) << total;
    EXPECT_GE(most.size(), std::min<std::size_t>(250, total)) << total;
    for (const SomePlaces& some : {least, most}) {
      EXPECT_EQ(some[0], 0U);
      EXPECT_LT(some[some.size() - 1], total) << total;
      EXPECT_GE(some[some.size()], total) << total;  // none is forgotten at the end
    }
  }
}

}  // namespace
}  // namespace g3r
