// The points on the side of a noisy one: those of its own wall, weighed by their distance across the axis.
#include "orient/same_side.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// Two square grids of 0.1 with opposite normals, the first at z = 0 and facing up, the other so far below.
struct Walls {
  explicit Walls(double apart, int half = 12) {
    for (const double side : {1.0, -1.0}) {
      for (int i = -half; i <= half; ++i) {
        for (int j = -half; j <= half; ++j) {
          points.push_back({0.1 * i, 0.1 * j, side > 0 ? 0 : -apart});
          normals.push_back({0, 0, side});
        }
      }
    }
    middle = points.size() / 4;  // of the first
  }
  std::vector<Vec3> points, normals;
  std::size_t middle;
};

const Eigen::Vector3d kAcross(0, 0, 1);

TEST(SameSide, HasThePointsOfItsOwnWallWithTheirWeights) {
  const Walls walls(0.05);
  const Neighbours tree(walls.points);
  SameSide side(walls.points, tree, walls.normals);
  static_cast<void>(side.gather(walls.middle, kAcross, 0.45, 0.2));
  std::vector<std::uint32_t> expected;
  double total = 0;
  for (std::uint32_t i = 0; i < walls.points.size() / 2; ++i) {
    const double squared = vector::dot(walls.points[i], walls.points[i]);
    if (squared >= 0.45 * 0.45) continue;
    expected.push_back(i);
    total += 1 - squared / (0.45 * 0.45);
  }
  std::vector<std::uint32_t> found = side.indices();
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  EXPECT_NEAR(side.weight(), total, 1e-12);
  ASSERT_EQ(side.members().size(), side.indices().size());
  for (std::size_t k = 0; k < side.members().size(); ++k) {
    const FitPoint& m = side.members()[k];
    EXPECT_LT((m.p - to_eigen(walls.points[side.indices()[k]])).norm(), 1e-12);  // the middle is at the origin
    EXPECT_NEAR(m.weight, 1 - m.p.squaredNorm() / (0.45 * 0.45), 1e-12);
  }
}

// Both walls are alike, and half of the weight faces away; with one alone nothing does.
TEST(SameSide, KnowsTheShareThatFacesAway) {
  const Walls near(0.05), far(10);
  const Neighbours of_near(near.points), of_far(far.points);
  EXPECT_NEAR(SameSide(near.points, of_near, near.normals).gather(near.middle, kAcross, 0.45, 0.2), 0.5, 1e-12);
  EXPECT_EQ(SameSide(far.points, of_far, far.normals).gather(far.middle, kAcross, 0.45, 0.2), 0);
}

// Normals at 45 degrees from the axis are on its side, at 75 degrees on neither, at 135 they face away.
TEST(SameSide, SideEndsAtSixtyDegrees) {
  const auto gathered = [](double degrees, double& opposed) {
    const std::vector<Vec3> points{{0, 0, 0}, {0.1, 0, 0}};
    const double angle = degrees * std::acos(-1.0) / 180;
    const std::vector<Vec3> normals{{0, 0, 1}, {std::sin(angle), 0, std::cos(angle)}};
    const Neighbours tree(points);
    SameSide side(points, tree, normals);
    opposed = side.gather(0, kAcross, 0.5, 0.1);
    return side.members().size();
  };
  double opposed = 0;
  EXPECT_EQ(gathered(45, opposed), 2U);
  EXPECT_EQ(opposed, 0);
  EXPECT_EQ(gathered(75, opposed), 1U);
  EXPECT_EQ(opposed, 0);
  EXPECT_EQ(gathered(135, opposed), 1U);
  EXPECT_GT(opposed, 0.4);
}

TEST(SameSide, OfManyPointsSomeStandForAll) {
  const Walls walls(10, 40);
  const Neighbours tree(walls.points);
  SameSide side(walls.points, tree, walls.normals);
  static_cast<void>(side.gather(walls.middle, kAcross, 3.9, 0.2));
  EXPECT_GT(side.seen(), kPlaces);
  EXPECT_LE(side.members().size(), kPlaces);
  EXPECT_GT(side.members().size(), kPlaces / 4);
}

}  // namespace
}  // namespace g3r
