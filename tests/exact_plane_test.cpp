#include "cloud/exact_plane.h"
#include "base/vector.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

constexpr double kSpacing = 0.1;

std::vector<std::uint32_t> all_of(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> index(points.size());
  std::iota(index.begin(), index.end(), 0U);
  return index;
}

// Nine points of a plane through the origin with normal (1, 2, 2) / 3, and ten anywhere else.
std::vector<Vec3> plane_among_others() {
  shapes::Random random(7);
  std::vector<Vec3> points{{0, 0, 0}};
  while (points.size() < 9) {
    const double y = random.uniform(-0.2, 0.2), z = random.uniform(-0.2, 0.2);
    points.push_back({-2 * (y + z), y, z});
  }
  while (points.size() < 19) points.push_back({random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)});
  return points;
}

TEST(FindExactPlane, HoldsThePointsOfThePlaneAndHasItsNormal) {
  const std::vector<Vec3> points = plane_among_others();
  const ExactPlane plane = find_exact_plane(points, all_of(points), kSpacing);
  ASSERT_GE(plane.points.size(), 9U);
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(plane.points[i], i);
  EXPECT_NEAR(std::abs(plane.normal[0] + 2 * plane.normal[1] + 2 * plane.normal[2]) / 3, 1, 1e-6);
  EXPECT_GT(plane.breadth, 0.15);
}

TEST(FindExactPlane, OfTwoEqualOnesFacesTheDirectionAskedFor) {
  std::vector<Vec3> points{{0, 0, 0}};
  for (int i = 0; i < 8; ++i) {  // on a circle in each of two planes
    const double u = kSpacing * std::cos(0.7 + i), v = kSpacing * std::sin(0.7 + i);
    points.push_back({u, v, 0});
    points.push_back({0, u, v});
  }
  for (const Vec3& towards : {Vec3{0.6, 0, 0.8}, Vec3{0.8, 0, 0.6}}) {
    const ExactPlane plane = find_exact_plane(points, all_of(points), kSpacing, &towards);
    EXPECT_EQ(plane.points.size(), 9U);
    EXPECT_GT(std::abs(vector::dot(plane.normal, towards)), 0.79);
  }
}

TEST(BesidePlane, AreTheFirstAndThoseThatItDoesNotHold) {
  EXPECT_EQ(beside_plane({7, 3, 9, 4}, {7, 9}), (std::vector<std::uint32_t>{7, 3, 4}));
  EXPECT_EQ(beside_plane({7}, {}), (std::vector<std::uint32_t>{7}));
}

TEST(FindExactPlane, IsNotProvedByALineOrByACurvedSurface) {
  std::vector<Vec3> line;
  for (int i = 0; i < 20; ++i) line.push_back({0.01 * i, 0.02 * i, -0.01 * i});
  EXPECT_TRUE(find_exact_plane(line, all_of(line), kSpacing).points.empty());
  shapes::Random random(1);
  std::vector<Vec3> ball;
  for (int i = 0; i < 30; ++i) ball.push_back(random.direction());
  EXPECT_TRUE(find_exact_plane(ball, all_of(ball), kSpacing).points.empty());
}

}  // namespace
}  // namespace g3r
