#include "cloud/quadratic_patch.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

constexpr double kRegularised = 2e-5;  // fits add 1e-9 of the weights to their equations, for points that do not determine them

// z = 0.3 x^2 - 0.2 x y + 0.1 y^2 and its unit normal, at places symmetric about the origin, so that the tangent plane is z = 0.
std::vector<FitPoint> quadric(double weight) {
  shapes::Random random(5);
  std::vector<FitPoint> points;
  for (int i = 0; i < 12; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = 0.3 * x * x - 0.2 * x * y + 0.1 * y * y;
    for (const double s : {1.0, -1.0}) {
      const Eigen::Vector3d n(-s * (0.6 * x - 0.2 * y), -s * (-0.2 * x + 0.2 * y), 1);
      points.push_back({{s * x, s * y, z}, n.normalized(), weight, 0});
    }
  }
  return points;
}

TEST(QuadraticPatch, IsExactOnQuadrics) {
  for (const double weight : {1.0, 1e-3}) {
    const std::vector<FitPoint> points = quadric(weight);
    const QuadraticPatch patch = fit_quadratic_patch(points, 0, 0.3, 0.25);
    for (const FitPoint& p : points) {
      Eigen::Vector3d gradient;
      EXPECT_NEAR(patch.distance(p.p, &gradient), 0, kRegularised);
      EXPECT_NEAR(gradient.dot(p.n), 1, 1e-9);
    }
    EXPECT_GT(patch.distance({0, 0, 0.1}), 0.09);
    EXPECT_LT(patch.distance({0, 0, -0.1}), -0.09);
  }
}

TEST(QuadraticPatch, LeavesOutPointsOfOtherPatches) {
  std::vector<FitPoint> points = quadric(1);
  points.push_back({{0, 0, 5}, {1, 0, 0}, 100, 1});
  points.push_back({{0, 0, 5}, {1, 0, 0}, 100, -1});
  EXPECT_NEAR(fit_quadratic_patch(points, 0, 0.3, 0.25).distance(points[0].p), 0, kRegularised);
}

TEST(QuadraticResidual, IsZeroOnQuadricsAndTheNoiseElsewhere) {
  constexpr std::size_t kCount = 4000;
  constexpr double kNoise = 0.01;
  shapes::Random random(2);
  std::vector<Vec3> exact, noisy;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = 1 + 0.05 * x * y - 0.03 * y * y;
    exact.push_back({x, y, z});
    noisy.push_back({x, y, z + kNoise * random.gaussian()});
  }
  std::vector<std::uint32_t> index(kCount);
  std::iota(index.begin(), index.end(), 0U);
  EXPECT_LT(quadratic_residual(exact, index.data(), kCount, {0, 0, 1}, 0.5), kRegularised);
  EXPECT_NEAR(quadratic_residual(noisy, index.data(), kCount, {0, 0, 1}, 0.5), kNoise, 0.05 * kNoise);
}

TEST(TangentFrame, IsRightHandedWithTheNormalLast) {
  shapes::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d n = to_eigen(random.direction());
    const Eigen::Matrix3d frame = tangent_frame(n);
    EXPECT_LT((frame * frame.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(frame.determinant(), 1, 1e-12);
    EXPECT_LT((frame.row(2).transpose() - n).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace g3r
