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
  const Noise noise = estimate_noise(points, Neighbours(points.positions));
  EXPECT_LT(noise.position, 1e-6);
  EXPECT_LT(noise.normal, 1e-6);
}

TEST(EstimateNoise, IsTheScatterInSpacings) {
  const OrientedPoints points = square(0.3 * kStep);
  EXPECT_NEAR(estimate_noise(points, Neighbours(points.positions)).position, 0.3, 0.05);
}

TEST(Denoise, BringsPointsOfAPlaneBackToItAndLeavesThoseOnIt) {
  for (const double sigma : {0.0, 0.3 * kStep}) {
    OrientedPoints points = square(sigma);
    const std::vector<Vec3> copy = points.positions;
    const Neighbours neighbours(copy);
    denoise(points, neighbours, estimate_noise(points, neighbours));
    EXPECT_LE(root_mean_square_height(points), 0.5 * sigma + 1e-9) << sigma;
    for (std::size_t i = 0; i < copy.size(); ++i) {
      EXPECT_NEAR(points.positions[i][0], copy[i][0], sigma + 1e-9);
      EXPECT_GT(points.normals[i][2], sigma > 0 ? 0.9 : 1 - 1e-9);
    }
  }
}

}  // namespace
}  // namespace g3r::mesh
