#include "mesh/field_denoise.h"

#include "mesh/smooth_spacing.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r::mesh {
namespace {

constexpr int kSide = 40;
constexpr double kStep = 0.05;

// A square of z = 0 whose points scatter by `sigma` along their normals.
OrientedPoints square(double sigma) {
  shapes::Random random(11);
  OrientedPoints points;
  for (int i = 0; i < kSide * kSide; ++i) {
    points.positions.push_back({kStep * (i % kSide), kStep * (i / kSide), sigma * random.gaussian()});
    points.normals.push_back({0, 0, 1});
  }
  points.spacing.assign(points.positions.size(), kStep);
  return points;
}

double root_mean_square_height(const OrientedPoints& points) {
  double sum = 0;
  for (const Vec3& p : points.positions) sum += p[2] * p[2];
  return std::sqrt(sum / static_cast<double>(points.positions.size()));
}

TEST(EstimateNoise, IsNoneOnAPlane) {
  const OrientedPoints points = square(0);
  const Noise noise = noise_about_fits(points, Neighbours(points.positions), kStep);
  EXPECT_LT(noise.position, 1e-6);
  EXPECT_LT(noise.normal, 1e-6);
}

TEST(EstimateNoise, IsTheScatterInSpacings) {
  const OrientedPoints points = square(0.3 * kStep);
  EXPECT_NEAR(noise_about_fits(points, Neighbours(points.positions), kStep).position, 0.3, 0.05);
}

TEST(Denoise, BringsPointsOfAPlaneBackToItAndLeavesThoseOnIt) {
  for (const double sigma : {0.0, 0.3 * kStep}) {
    OrientedPoints points = square(sigma);
    const std::vector<Vec3> copy = points.positions;
    const Neighbours neighbours(copy);
    denoise(points, neighbours, noise_about_fits(points, neighbours, kStep), kStep);
    EXPECT_LE(root_mean_square_height(points), 0.5 * sigma + 1e-9) << sigma;
    for (std::size_t i = 0; i < copy.size(); ++i) {
      EXPECT_NEAR(points.positions[i][0], copy[i][0], sigma + 1e-9);
      EXPECT_GT(points.normals[i][2], sigma > 0 ? 0.9 : 1 - 1e-9);
    }
  }
}

// Under one noise, a spacing of dense points and a quarter of that of sparse ones, the dense ones come to their plane, and the sparse ones
// keep a wave of six of their spacings.
TEST(Denoise, KeepsTheDetailOfSparsePointsUnderTheNoiseOfDenseOnes) {
  constexpr double kNoise = kStep, kSparse = 4 * kStep, kHeight = 3 * kStep, kWave = 2 * M_PI / (6 * kSparse);
  constexpr int kSparseSide = 30;
  OrientedPoints points = square(kNoise);
  shapes::Random random(12);
  const std::size_t dense = points.positions.size();
  const auto wave = [](double x) { return kHeight * std::sin(kWave * x); };
  for (int i = 0; i < kSparseSide * kSparseSide; ++i) {
    const double x = 10 + kSparse * (i % kSparseSide), slope = kHeight * kWave * std::cos(kWave * x), size = std::hypot(1, slope);
    points.positions.push_back({x, kSparse * (i / kSparseSide), wave(x) + kNoise * random.gaussian()});
    points.normals.push_back({-slope / size, 0, 1 / size});
    points.spacing.push_back(kSparse);
  }
  const std::vector<Vec3> copy = points.positions;
  const Neighbours neighbours(copy);
  denoise(points, neighbours, {kNoise / kStep, 0.3}, kStep);
  double on_dense = 0, on_sparse = 0;
  for (std::size_t i = 0; i < copy.size(); ++i) {
    const auto& [x, y, z] = points.positions[i];
    (i < dense ? on_dense : on_sparse) += i < dense ? z * z : (z - wave(x)) * (z - wave(x));
  }
  EXPECT_LT(std::sqrt(on_dense / static_cast<double>(dense)), 0.4 * kNoise);
  EXPECT_LT(std::sqrt(on_sparse / static_cast<double>(copy.size() - dense)), kNoise);
}

}  // namespace
}  // namespace g3r::mesh
