// What lies behind a surface is hidden; neither the surface itself, noise nor strays hide a point.
#include "cloud/blocked_sights.h"

#include "sides.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

namespace g3r {
namespace {

using sides::Sides;

// Squares of 400 points, the one above the other: z = 0 and z = 1.
Sides two_squares() {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({0, 0, 1}, 2, 1, 1);
  return sides;
}

// Of the points of one square, the share whose sight from a place is blocked.
double blocked_share(const Sides& sides, std::uint32_t square, const Vec3& place) {
  const PointSet set(sides.points);
  double blocked = 0;
  for (std::uint32_t i = 400 * square; i < 400 * (square + 1); ++i) blocked += is_blocked(set, seen_point(set, i), place) ? 1 : 0;
  return blocked / 400;
}

TEST(IsBlocked, WhereAnotherSurfaceIsBetween) {
  const Sides sides = two_squares();
  EXPECT_EQ(blocked_share(sides, 1, {0, 0, 30}), 0);
  EXPECT_EQ(blocked_share(sides, 0, {0, 0, 30}), 1);
  EXPECT_EQ(blocked_share(sides, 0, {0, 0, -30}), 0);
  EXPECT_EQ(blocked_share(sides, 1, {0, 0, -30}), 1);
  for (std::uint32_t square = 0; square < 2; ++square) EXPECT_EQ(blocked_share(sides, square, {0, 0, 0.5}), 0) << square;
}

// However grazing, a surface does not hide itself, and under noise it does not either.
TEST(IsBlocked, NotByTheSurfaceItself) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  for (const double height : {0.01, 0.1, 1.0}) EXPECT_EQ(blocked_share(sides, 0, {5, 0, height}), 0) << height;
  for (std::size_t i = 0; i < sides.points.size(); ++i) sides.points[i][2] = 0.1 * static_cast<double>(i * 7 % 5) - 0.2;
  EXPECT_LT(blocked_share(sides, 0, {0, 0, 3}), 0.01);
}

// A few strays in front are no surface.
TEST(IsBlocked, NotByStrays) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  for (int k = 0; k < 9; ++k) sides.add({0.6 * (k % 3) - 0.6, 0.6 * (k / 3) - 0.6, 1}, {0, 0, 1}, 1, true);
  EXPECT_EQ(blocked_share(sides, 0, {0, 0, 30}), 0);
}

}  // namespace
}  // namespace g3r
