// Planes through points: exact where these are in one, without a bias where they scatter, and moving with them.
#include "cloud/plane_fit.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

constexpr double kRoundingOfFit = 1e-7;  // of eigenvectors by the closed formula

PlaneFit fit(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> index(points.size());
  std::iota(index.begin(), index.end(), std::uint32_t{0});
  return fit_plane(points, index.data(), index.size());
}

// A rectangle of 1 by `breadth` in the plane across `normal` through a place off the origin.
std::vector<Vec3> rectangle(std::size_t count, double breadth, const Vec3& normal) {
  const Vec3 u = vector::normalised(vector::cross(normal, {0.3, -0.5, 0.8})), v = vector::cross(normal, u);
  shapes::Random random(4);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 across = vector::add(vector::scale(u, random.uniform(-1, 1)), vector::scale(v, random.uniform(-breadth, breadth)));
    points.push_back(vector::add(across, {5, -3, 2}));
  }
  return points;
}

TEST(PlaneFit, OfPointsInAPlaneIsThatPlane) {
  shapes::Random random(8);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 normal = random.direction();
    const PlaneFit plane = fit(rectangle(30, 0.6, normal));
    EXPECT_NEAR(std::abs(vector::dot(plane.normal, normal)), 1, kRoundingOfFit);
    EXPECT_NEAR(vector::length(plane.normal), 1, kRoundingOfFit);
    EXPECT_LT(plane.residual, kRoundingOfFit);
    EXPECT_LT(plane.flatness, kRoundingOfFit);
  }
}

// The spreads of an even distribution are in proportion to its sides.
TEST(PlaneFit, BreadthIsThatOfTheRectangle) {
  for (const double breadth : {1.0, 0.5, 0.1}) EXPECT_NEAR(fit(rectangle(20000, breadth, {0, 0, 1})).breadth / breadth, 1, 0.03) << breadth;
}

TEST(PlaneFit, OfABallIsNotFlat) {
  shapes::Random random(6);
  std::vector<Vec3> points;
  for (int i = 0; i < 20000; ++i) points.push_back(vector::scale(random.direction(), std::cbrt(random.uniform())));
  const PlaneFit ball = fit(points);
  EXPECT_GT(ball.flatness, 0.97);
  EXPECT_GT(ball.breadth, 0.97);
}

// The mean square of the residuals is the variance of the noise for any number of points, as three of them go into the plane.
TEST(PlaneFit, ResidualHasNoBiasOfFewPoints) {
  constexpr double kNoise = 0.01;
  constexpr int kTrials = 4000;
  for (const std::size_t count : {5U, 8U, 24U}) {
    shapes::Random random(2);
    double squares = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<Vec3> points;
      for (std::size_t i = 0; i < count; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), kNoise * random.normal()});
      squares += std::pow(fit(points).residual, 2);
    }
    // The relative deviation of the mean is sqrt(2 / (count - 3) / kTrials), 0.016 of five points.
    EXPECT_NEAR(squares / kTrials / (kNoise * kNoise), 1, 0.05) << count;
  }
}

}  // namespace
}  // namespace g3r
