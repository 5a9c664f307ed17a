#include "orient/two_walls.h"

#include "cloud/canonical_cloud.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

constexpr std::size_t kPoints = 6000;

// On [-1, 1]^2, `gap` and `noise` in spacings: half of the points on a second wall. Tilted, so that no coordinate is along the walls.
std::vector<Vec3> walls(double gap, double noise, double waves = 0, std::size_t count = kPoints, std::uint64_t seed = 11) {
  const double h = 2 / std::sqrt(static_cast<double>(count));
  shapes::Random random(seed);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    const double z = waves * std::sin(5 * x) * std::cos(4 * y) + (i % 2 == 0 ? gap * h : 0) + noise * h * random.normal();
    points.push_back({0.8 * x - 0.6 * z, y, 0.6 * x + 0.8 * z});
  }
  return points;
}

bool found(const std::vector<Vec3>& points, double noise) {
  const CanonicalCloud cloud = canonical_cloud(PointsView(points));
  const Sites sites = place_sites(cloud.set, noise > 0 ? 1.5 * cloud.set.spacing() : 0);
  std::vector<std::uint32_t> all(sites.size());
  std::iota(all.begin(), all.end(), 0U);
  return on_two_walls(cloud.set, sites, all, noise * cloud.set.spacing(), std::vector<double>(sites.size(), 0));
}

TEST(TwoWalls, OneSurfaceIsNone) {
  for (const double noise : {0.0, 0.2, 0.6, 1.0}) {
    EXPECT_FALSE(found(walls(0, noise), noise)) << noise;
    EXPECT_FALSE(found(walls(0, noise, 0.15), noise)) << noise;
  }
}

TEST(TwoWalls, AreFoundWithoutNoise) {
  for (const double gap : {0.2, 0.5, 1.0}) EXPECT_TRUE(found(walls(gap, 0), 0)) << gap;
}

// Rays on a grid hit a plate as thick as they are apart: a cubic lattice, along which a plane through both walls may lie in any direction.
TEST(TwoWalls, OfARasterAreFoundHoweverItLies) {
  std::vector<Vec3> straight;
  for (int x = 0; x < 120; ++x) {
    for (int y = 0; y < 40; ++y) {
      for (const double z : {0.0, 1.0}) straight.push_back({1.0 * x, 1.0 * y, z});
    }
  }
  EXPECT_TRUE(found(straight, 0));
  std::vector<Vec3> turned;
  for (const Vec3& p : straight) turned.push_back({0.8 * p[0] - 0.6 * p[2], p[1], 0.6 * p[0] + 0.8 * p[2]});
  EXPECT_TRUE(found(turned, 0));
}

// Scans that overlap and are a little off each other are two walls where they overlap, and so is a plate with a rim. What makes a field
// restless on account of walls does so where these are.
TEST(TwoWalls, AreNoReasonForUnrestBesideThem) {
  const std::vector<Vec3> two = walls(0.5, 0.02);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < two.size(); ++i) {
    if (i % 2 == 1 || two[i][1] < 0.4) points.push_back(two[i]);
  }
  const CanonicalCloud cloud = canonical_cloud(PointsView(points));
  const Sites sites = place_sites(cloud.set, 0);
  std::vector<std::uint32_t> all(sites.size());
  std::iota(all.begin(), all.end(), 0U);
  const double rim = cloud.frame.to_unit({0, 0.4, 0})[1];
  const auto found_with = [&](double on_walls, double beside) {
    std::vector<double> unrest;
    for (const Vec3& p : sites.points()) unrest.push_back(p[1] < rim ? on_walls : beside);
    return on_two_walls(cloud.set, sites, all, 0, unrest);
  };
  EXPECT_TRUE(found_with(0.2, 0.03));
  EXPECT_TRUE(found_with(0.2, 0.1));
  EXPECT_TRUE(found_with(0.05, 0.06));
  EXPECT_FALSE(found_with(0.1, 0.1));
  EXPECT_FALSE(found_with(0.1, 0.2));
}

// The fewer neighbourhoods a surface has, the likelier is it that all of them look like two walls by chance.
TEST(TwoWalls, SmallSurfacesAreNone) {
  int taken = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) taken += found(walls(0, 0.2, 0, 1000, seed), 0.2) ? 1 : 0;
  EXPECT_LE(taken, 2);
}

// Two standard deviations apart heights have one peak, not two: only the kurtosis shows it. One deviation apart nothing does.
TEST(TwoWalls, AreFoundTwoDeviationsApart) {
  for (const double noise : {0.2, 0.5, 0.8}) {
    EXPECT_TRUE(found(walls(2 * noise, noise), noise)) << noise;
    EXPECT_TRUE(found(walls(2 * noise, noise, 0.15), noise)) << noise;
    EXPECT_FALSE(found(walls(noise, noise), noise)) << noise;
  }
}

// Rounding has light tails as well: one terrain of voxels is one surface.
TEST(TwoWalls, VoxelsAreNone) {
  std::vector<Vec3> points = walls(0, 0.1, 0.15);
  const double step = 3 / std::sqrt(static_cast<double>(kPoints));
  for (Vec3& p : points) {
    for (double& c : p) c = step * std::round(c / step);
  }
  EXPECT_FALSE(found(points, 0.3));
}

// A pixel raster sees a slope in steps of depth: terraces, which lie side by side.
TEST(TwoWalls, StepsOfDepthAreNone) {
  const double h = 2 / std::sqrt(static_cast<double>(kPoints));
  for (const double step : {0.3, 0.6, 1.0}) {
    std::vector<Vec3> points;
    for (double x = -1; x < 1; x += h) {
      for (double y = -1; y < 1; y += h) {
        const double z = 0.5 * (x * x + 0.7 * y * y) + 0.31 * x;
        points.push_back({x, y, step * h * std::round(z / (step * h))});
      }
    }
    EXPECT_FALSE(found(points, 0)) << step;
  }
}

}  // namespace
}  // namespace g3r
