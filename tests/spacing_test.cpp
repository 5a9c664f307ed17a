#include "cloud/spacing.h"

#include "mesh/smooth_spacing.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

std::vector<Vec3> grid(int side, double step) {
  std::vector<Vec3> points;
  for (int i = 0; i < side * side; ++i) points.push_back({step * (i % side), step * (i / side), 0});
  return points;
}

TEST(LocalSpacing, IsTheRootOfTheAreaOfAPoint) {
  const shapes::Surface sphere = shapes::sphere(2000);
  const double truth = std::sqrt(sphere.areas[0]);  // the same for all
  EXPECT_NEAR(typical_spacing(local_spacing(sphere.points)), truth, 0.06 * truth);
}

TEST(LocalSpacing, ScalesWithThePoints) {
  const std::vector<double> h = local_spacing(shapes::torus(500, 0.6, 0.25, 3).points);
  const std::vector<double> twice = local_spacing(shapes::torus(500, 1.2, 0.5, 3).points);
  for (std::size_t i = 0; i < h.size(); ++i) EXPECT_NEAR(twice[i], 2 * h[i], 1e-12);
}

TEST(LocalSpacing, OfFewPointsUsesAllOthers) {
  const std::vector<double> h = local_spacing({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_NEAR(h[0], std::sqrt(std::numbers::pi / 2), 1e-12);
  EXPECT_NEAR(h[1], std::sqrt(2 * std::numbers::pi / 2), 1e-12);
}

TEST(TypicalSpacing, IsNotMovedByAFewFarPoints) {
  std::vector<Vec3> points = grid(20, 0.05);
  const double h = typical_spacing(local_spacing(points));
  for (int i = 0; i < 10; ++i) points.push_back({100.0 + 10 * i, 0, 0});
  EXPECT_NEAR(typical_spacing(local_spacing(points)), h, 1e-12);
}

TEST(SmoothedSpacing, IsTheGeometricMeanOfTheSixteenNearest) {
  std::vector<double> local(17, 1);
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < 17; ++i) {
    for (std::uint32_t k = 0; k < 17; ++k) near.push_back(static_cast<std::uint32_t>((i + k) % 17));
  }
  local[0] = 1 << 16;
  const std::vector<double> h = smoothed_spacing(local, near);
  EXPECT_NEAR(h[0], 2, 1e-12);
  EXPECT_NEAR(h[1], 1, 1e-12);
  EXPECT_NEAR(h[16], 2, 1e-12);
}

TEST(SmoothSpacing, OfAGridIsThatOfItsDiagonalNeighbours) {
  constexpr int kSide = 12;
  const std::vector<double> h = mesh::smooth_spacing(grid(kSide, 0.05));
  EXPECT_NEAR(h[kSide * kSide / 2 + kSide / 2], 0.05 * std::sqrt(2 * std::numbers::pi / 8), 1e-12);
}

TEST(SmoothSpacing, IsNotLedAstrayByALoneOutlier) {
  std::vector<Vec3> points = grid(12, 0.05);
  const std::vector<double> before = mesh::smooth_spacing(points);
  points.push_back({0.3, 0.3, 50});
  const std::vector<double> after = mesh::smooth_spacing(points);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
}

}  // namespace
}  // namespace g3r
