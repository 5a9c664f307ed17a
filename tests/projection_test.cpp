// Noisy points moved onto their surface: as near as the formula says, wall by wall, and what that is worth.
#include "orient/projection.h"

#include "cloud/point_set.h"
#include "cpu/parallel.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr double kSpacing = 0.02;

// Random points of a square of side 1.8 at height z that faces up or down, one for each square of side kSpacing.
Surface square(double z, double up, std::uint64_t seed) {
  shapes::Random random(seed);
  Surface s;
  const auto count = static_cast<std::size_t>(1.8 * 1.8 / (kSpacing * kSpacing));
  for (std::size_t i = 0; i < count; ++i) {
    s.points.push_back({random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), z});
    s.normals.push_back({0, 0, up});
    s.areas.push_back(kSpacing * kSpacing);
  }
  return s;
}

std::vector<Vec3> projected(const Surface& s, double noise) {
  const PointSet set(s.points);
  return project_points(set.points(), set.tree(), s.normals, noise, {kSpacing});
}

// Of points at least 0.3 from the rim, the root mean square height over z.
double deviation(const std::vector<Vec3>& points, std::size_t begin, std::size_t end, double z) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (std::max(std::abs(points[i][0]), std::abs(points[i][1])) > 0.6) continue;
    sum += (points[i][2] - z) * (points[i][2] - z);
    ++count;
  }
  return std::sqrt(sum / count);
}

// Integrals over the unit disk of the kernel (6 / pi) (1 - r^2) (1 - 2 r^2), by the midpoint rule: 1, no second moment, and the variance.
TEST(Projection, NoiseIsThatOfTheEquivalentKernel) {
  constexpr int kSteps = 10000;
  double sum = 0;
  double second = 0;
  double squares = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double r = (k + 0.5) / kSteps;
    const double kernel = 6 / std::numbers::pi * (1 - r * r) * (1 - 2 * r * r);
    const double area = 2 * std::numbers::pi * r / kSteps;
    sum += kernel * area;
    second += r * r * kernel * area;
    squares += kernel * kernel * area;
  }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_NEAR(second, 0, 1e-6);
  const double sigma = 0.5;
  EXPECT_NEAR(projected_noise(sigma, 0.1), sigma * 0.1 / projection_reach(sigma, 0.1) * std::sqrt(squares), 1e-6);
  EXPECT_EQ(projected_noise(0.01, 0.1), 0.01);  // the reach holds too few points to gain anything
}

TEST(Projection, LeavesTheNoiseOfTheFormulaOnAPlane) {
  for (const double sigma : {0.8, 1.6}) {
    Surface s = square(0, 1, 5);
    shapes::scatter(s, sigma * kSpacing);
    const double left = deviation(projected(s, sigma * kSpacing), 0, s.points.size(), 0);
    EXPECT_NEAR(left / projected_noise(sigma * kSpacing, kSpacing), 1, 0.2) << sigma;
  }
}

// A sphere of curvature c: what a quadratic cannot follow is of fourth order.
TEST(Projection, DoesNotShrinkASphere) {
  const std::size_t count = 20000;
  const double h = 0.9 * std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
  Surface s = shapes::sphere(count);
  shapes::scatter(s, 0.8 * h);
  const PointSet set(s.points);
  const std::vector<Vec3> moved = project_points(set.points(), set.tree(), s.normals, 0.8 * h, {h});
  double mean = 0;
  for (const Vec3& p : moved) mean += (std::hypot(p[0], p[1], p[2]) - 0.9) / static_cast<double>(count);
  EXPECT_LT(std::abs(mean), 0.02 * h);
}

// The noise of each wall reaches into the other: of 4 sigma between them half are left to each.
TEST(Projection, KeepsThePointsOfTwoWallsApart) {
  const double sigma = 0.8 * kSpacing;
  const Surface lower = square(0, -1, 5);
  Surface s = shapes::join(lower, square(4 * sigma, 1, 6));
  shapes::scatter(s, sigma);
  const std::vector<Vec3> moved = projected(s, sigma);
  const std::size_t half = lower.points.size();
  EXPECT_LT(deviation(moved, 0, half, 0), 0.6 * sigma);
  EXPECT_LT(deviation(moved, half, moved.size(), 4 * sigma), 0.6 * sigma);
}

TEST(Projection, DoesNotAskWhichSideAWallFaces) {
  Surface s = square(0, 1, 5);
  shapes::scatter(s, 0.8 * kSpacing);
  const std::vector<Vec3> moved = projected(s, 0.8 * kSpacing);
  for (Vec3& n : s.normals) n = {0, 0, -1};
  const std::vector<Vec3> turned = projected(s, 0.8 * kSpacing);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(moved[i][a], turned[i][a], 1e-12);
  }
}

TEST(Projection, LeavesPointsOnAPlaneAndFewOnesWhereTheyAre) {
  const Surface s = square(0.3, 1, 5);
  for (const Vec3& p : projected(s, 0.5 * kSpacing)) EXPECT_NEAR(p[2], 0.3, 1e-12);
  const PointSet few({{0, 0, 0}, {1, 0, 0.1}, {0, 1, 0}});
  EXPECT_EQ(project_points(few.points(), few.tree(), {3, {0, 0, 1}}, 0.1, {1}), few.points());
}

TEST(Projection, IsTheSameWithAnyNumberOfThreadsAndStopsWhenAsked) {
  Surface s = square(0, 1, 5);
  shapes::scatter(s, 0.8 * kSpacing);
  const auto with = [&](int threads) { return parallel::with_threads(threads, [&] { return projected(s, 0.8 * kSpacing); }); };
  EXPECT_EQ(with(1), with(0));
  const PointSet set(s.points);
  const std::atomic<bool> cancel{true};
  EXPECT_THROW((void)project_points(set.points(), set.tree(), s.normals, 0.1, {kSpacing}, &cancel), Cancelled);
}

// Plates whose gaps are 2.6 spacings wide, under noise of 0.9: kernels that hide the noise hide the gaps.
TEST(Projection, FindsMoreSidesInNarrowGaps) {
  constexpr double kApart = 0.03;
  Surface s = shapes::plates(5, 1, 5, 2.6, kApart);
  shapes::scatter(s, 0.9 * kApart);
  Options options;
  options.without = "noise-choice";  // which finds narrower kernels here
  const double with = shapes::share_correct(orient(s.points, options).normals, s.normals);
  options.without = "noise-choice,projection";
  const double none = shapes::share_correct(orient(s.points, options).normals, s.normals);
  EXPECT_LT(1 - with, 0.8 * (1 - none));
}

}  // namespace
}  // namespace g3r
