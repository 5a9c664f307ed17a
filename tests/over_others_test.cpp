// What lies over other points may have been seen from below, whatever is said to be up.
#include "orient/over_others.h"

#include "sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using sides::Sides;

std::size_t count(const std::vector<std::uint8_t>& marks, std::size_t begin, std::size_t end) {
  return static_cast<std::size_t>(
      std::count(marks.begin() + static_cast<std::ptrdiff_t>(begin), marks.begin() + static_cast<std::ptrdiff_t>(end), 1));
}

// A canopy of 400 points over a floor of 400: it is marked, the floor is not, and neither is a wall between them.
TEST(OverOthers, ACanopyIsOverItsFloor) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({0, 0, 2}, 2, 1, 1);
  sides.add_square({1, 0, 1}, 0, 1, 2);
  const std::vector<std::uint8_t> marks = over_others(sides.points, sides.normals, {0, 0, 1}, 0, nullptr);
  EXPECT_EQ(count(marks, 0, 400), 0);
  EXPECT_EQ(count(marks, 400, 800), 400);
  EXPECT_EQ(count(marks, 800, 1200), 0);
  // With the floor said to be above, it is the floor that lies over the canopy.
  const std::vector<std::uint8_t> turned = over_others(sides.points, sides.normals, {0, 0, -1}, 0, nullptr);
  EXPECT_EQ(count(turned, 0, 400), 400);
  EXPECT_EQ(count(turned, 400, 800), 0);
}

// A slope lies over nothing, however steep and however it is turned about the vertical; nor does noise.
TEST(OverOthers, ASlopeIsOverNothing) {
  for (const double degrees : {0.0, 30.0, 55.0, 65.0, 89.0}) {
    for (const double turn : {0.0, 0.4}) {
      const double slope = degrees * std::numbers::pi / 180;
      Sides sides;
      for (int i = 0; i < 30; ++i) {
        for (int j = 0; j < 30; ++j) {
          const double along = 0.1 * i * std::cos(slope), across = 0.1 * j, z = 0.1 * i * std::sin(slope);
          const double x = along * std::cos(turn) - across * std::sin(turn), y = along * std::sin(turn) + across * std::cos(turn);
          sides.add({x, y, z}, {-std::sin(slope) * std::cos(turn), -std::sin(slope) * std::sin(turn), std::cos(slope)}, 0, true);
        }
      }
      EXPECT_EQ(count(over_others(sides.points, sides.normals, {0, 0, 1}, 0, nullptr), 0, 900), 0) << degrees << ' ' << turn;
    }
  }
}

TEST(OverOthers, NoiseIsNoSecondSurface) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  for (std::size_t i = 0; i < sides.points.size(); ++i) sides.points[i][2] += 0.6 * std::sin(12.9898 * static_cast<double>(i));
  EXPECT_GT(count(over_others(sides.points, sides.normals, {0, 0, 1}, 0, nullptr), 0, 400), 100);
  EXPECT_EQ(count(over_others(sides.points, sides.normals, {0, 0, 1}, 0.3, nullptr), 0, 400), 0);
}

}  // namespace
}  // namespace g3r
