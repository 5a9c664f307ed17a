// Morton codes interleave the bits of the coordinates, and the order of points depends on the points alone.
#include "cloud/morton.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

std::vector<Vec3> random_points(std::size_t count) {
  shapes::Random random(11);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  return points;
}

std::vector<Vec3> sorted_points(const std::vector<Vec3>& points) {
  std::vector<Vec3> sorted;
  for (const std::uint32_t i : morton_order(points)) sorted.push_back(points[i]);
  return sorted;
}

TEST(SpreadBits, MovesEveryBitToThreeTimesItsPlace) {
  std::uint64_t all = 0;
  for (int bit = 0; bit < kGridBits; ++bit) {
    EXPECT_EQ(spread_bits(std::uint64_t{1} << bit), std::uint64_t{1} << (3 * bit)) << bit;
    all |= std::uint64_t{1} << (3 * bit);
  }
  EXPECT_EQ(spread_bits((std::uint64_t{1} << kGridBits) - 1), all);
  EXPECT_EQ(spread_bits(std::uint64_t{1} << kGridBits), 0U);
}

// Of the cell (x, y, z) of the grid bit i of x is bit 3 i + 2 of the code, of y bit 3 i + 1, of z bit 3 i.
TEST(MortonCode, InterleavesTheCellsOfTheAxes) {
  const double cell = std::ldexp(2.0, -kGridBits);
  shapes::Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::array<std::uint64_t, 3> cells{};
    Vec3 point{};
    for (std::size_t a = 0; a < 3; ++a) {
      cells[a] = random.bits() >> (64 - kGridBits);
      point[a] = (static_cast<double>(cells[a]) + 0.5) * cell - 1;
    }
    const std::uint64_t code = morton_code(point);
    for (std::size_t a = 0; a < 3; ++a) {
      for (int bit = 0; bit < kGridBits; ++bit) {
        ASSERT_EQ(code >> (3 * bit + 2 - static_cast<int>(a)) & 1U, cells[a] >> bit & 1U) << a << " " << bit;
      }
    }
  }
}

TEST(MortonCode, ClampsWhatIsOutside) {
  EXPECT_EQ(morton_code({-7, -7, -7}), morton_code({-1, -1, -1}));
  EXPECT_EQ(morton_code({7, 1, 1}), morton_code({1, 1, 1}));
  EXPECT_EQ(morton_code({-1, -1, -1}), 0U);
  EXPECT_EQ(morton_code({1, 1, 1}), (std::uint64_t{1} << (3 * kGridBits)) - 1);
}

TEST(MortonOrder, SortsTheCodesAndDependsOnThePointsAlone) {
  const std::vector<Vec3> points = random_points(5000);
  const std::vector<Vec3> sorted = sorted_points(points);
  const std::vector<std::uint64_t> codes = morton_codes(sorted);
  EXPECT_TRUE(std::is_sorted(codes.begin(), codes.end()));
  std::vector<Vec3> turned(points.rbegin(), points.rend());
  std::rotate(turned.begin(), turned.begin() + 1234, turned.end());
  EXPECT_EQ(sorted_points(turned), sorted);
}

// A cell is 2 / 2^21 = 9.5e-7 wide.
TEST(MortonOrder, PointsOfOneCellComeByTheirCoordinatesAndEqualOnesByTheirIndex) {
  const double cell = std::ldexp(2.0, -kGridBits);
  const std::vector<Vec3> points{{0.75 * cell, 0, 0}, {0.25 * cell, 0, 0}, {0.5 * cell, 0, 0}, {0.25 * cell, 0, 0}};
  EXPECT_EQ(morton_order(points), (std::vector<std::uint32_t>{1, 3, 2, 0}));
}

}  // namespace
}  // namespace g3r
