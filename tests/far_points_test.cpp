// Points so far from the others that no frame holds both.
#include "cloud/far_points.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace g3r {
namespace {

// 2,000 points of a ball of radius 1, and one so far away.
std::vector<Vec3> ball_and_one(double distance) {
  std::vector<Vec3> points = shapes::sphere(2000, 1).points;
  points.insert(points.begin() + 700, {distance, 0, 0});
  return points;
}

std::size_t marked(const std::vector<std::uint8_t>& marks) {
  return static_cast<std::size_t>(std::count(marks.begin(), marks.end(), std::uint8_t{1}));
}

// From 40,000 of the ball's sizes, which are about 1 from the middle point, the spacing of 2,000 points is a millionth of the frame.
TEST(FarPoints, AreThoseThatMakeTheOthersCoincide) {
  EXPECT_TRUE(far_points(ball_and_one(1e4)).empty());
  const std::vector<std::uint8_t> marks = far_points(ball_and_one(1e6));
  ASSERT_EQ(marks.size(), 2001U);
  EXPECT_EQ(marked(marks), 1U);
  EXPECT_EQ(marks[700], 1);
}

TEST(FarPoints, AreNoneOfASurfaceOrOfNothing) {
  EXPECT_TRUE(far_points(shapes::torus(3000, 0.6, 0.25, 4).points).empty());
  EXPECT_TRUE(far_points(std::vector<Vec3>{}).empty());
  EXPECT_TRUE(far_points(std::vector<Vec3>(5, Vec3{std::numeric_limits<double>::quiet_NaN(), 0, 0})).empty());
}

TEST(FarPoints, DoNotDependOnPlaceScaleOrOrder) {
  const std::vector<Vec3> points = ball_and_one(1e6);
  std::vector<Vec3> other;
  for (const Vec3& p : points) other.push_back(vector::scale(vector::add(p, {64, -32, 8}), 0x1p-20));
  EXPECT_EQ(far_points(other), far_points(points));
  const std::vector<Vec3> turned(points.rbegin(), points.rend());
  std::vector<std::uint8_t> marks = far_points(turned);
  std::reverse(marks.begin(), marks.end());
  EXPECT_EQ(marks, far_points(points));
}

// However often a far place is in the input, the others are the surface.
TEST(FarPoints, CopiesOfOneAreNoMajority) {
  std::vector<Vec3> points = shapes::sphere(2000, 1).points;
  points.insert(points.end(), 5000, {1e6, 0, 0});
  const std::vector<std::uint8_t> marks = far_points(points);
  ASSERT_EQ(marks.size(), points.size());
  EXPECT_EQ(marked(marks), 5000U);
  EXPECT_EQ(marks.front(), 0);
}

}  // namespace
}  // namespace g3r
