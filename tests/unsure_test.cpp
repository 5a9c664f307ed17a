// The points around unsure ones, as the distances to all of them say.
#include "orient/unsure.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

constexpr double kReachInSpacings = 5;  // as the header says

TEST(AroundUnsure, AreThoseWithinFiveSpacings) {
  const std::vector<Vec3> points = shapes::torus(1500, 0.6, 0.25, 7).points;
  std::vector<std::uint8_t> unsure(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); i += 400) unsure[i] = 1;
  std::vector<double> spacing;
  for (const Vec3& p : points) spacing.push_back(0.02 + 0.02 * std::abs(p[0]));
  for (const std::vector<double>& h : {spacing, std::vector<double>{0.03}}) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      double nearest = HUGE_VAL;
      for (std::size_t j = 0; j < points.size(); ++j) {
        if (unsure[j] != 0) nearest = std::min(nearest, vector::length(vector::subtract(points[i], points[j])));
      }
      if (nearest < kReachInSpacings * h[h.size() == 1 ? 0 : i]) expected.push_back(i);
    }
    EXPECT_EQ(around_unsure(points, h, unsure), expected);
    EXPECT_GT(expected.size(), 20U);
    EXPECT_LT(expected.size(), points.size());
  }
}

TEST(AroundUnsure, AreNoneWhereAllIsSureAndAllWhereNothingIs) {
  const std::vector<Vec3> points = shapes::sphere(100).points;
  EXPECT_TRUE(around_unsure(points, {0.2}, std::vector<std::uint8_t>(100, 0)).empty());
  EXPECT_EQ(around_unsure(points, {1e-6}, std::vector<std::uint8_t>(100, 1)).size(), 100U);
}

}  // namespace
}  // namespace g3r
