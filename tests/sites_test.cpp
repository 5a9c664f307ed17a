// Sites: an even distance apart, all points covered, planes of the surface rather than of its sampling.
#include "cloud/sites.h"

#include "base/vector.h"
#include "cloud/morton.h"
#include "cloud/spacing.h"
#include "cloud/surface_distance.h"

#include "shapes.h"

#include <g3r/error.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

namespace g3r {
namespace {

PointSet in_order(const std::vector<Vec3>& points) {
  const std::vector<std::uint32_t> order = morton_order(points);
  std::vector<Vec3> sorted;
  sorted.reserve(order.size());
  for (const std::uint32_t i : order) sorted.push_back(points[i]);
  return PointSet(std::move(sorted));
}

// Lines of a wavy surface, points about 0.01 apart along them.
std::vector<Vec3> scan_lines(double ratio, double jitter = 0.001) {
  shapes::Random random(1);
  std::vector<Vec3> points;
  for (double y = -0.9; y < 0.9; y += 0.01 * ratio) {
    for (double x = -0.9; x < 0.9; x += 0.01)
      points.push_back({x + jitter * random.gaussian(), y, 0.05 * std::sin(5 * x) * std::cos(4 * y)});
  }
  return points;
}

TEST(Sites, EveryPointIsOneAtDistanceZero) {
  const PointSet cloud = in_order(shapes::sphere(2000).points);
  const Sites sites = place_sites(cloud, 0);
  EXPECT_EQ(sites.points(), cloud.points());
  for (std::size_t i = 0; i < cloud.points().size(); ++i) EXPECT_EQ(sites.site_of[i], i);
}

TEST(Sites, HoldEveryPointWithinTheDistance) {
  const PointSet cloud = in_order(shapes::torus(6000, 0.6, 0.25, 2).points);
  const double distance = 3 * cloud.spacing();
  const Sites sites = place_sites(cloud, distance);
  EXPECT_LT(sites.points().size(), cloud.points().size() / 6);
  for (std::size_t i = 0; i < cloud.points().size(); ++i) {
    const Vec3 d = vector::subtract(cloud.points()[i], sites.points()[sites.site_of[i]]);
    EXPECT_LT(std::sqrt(vector::dot(d, d)), 2 * distance);  // from the first point of the site to its centroid, and to a point
  }
  const std::vector<std::uint64_t> codes = morton_codes(sites.points());
  EXPECT_TRUE(std::is_sorted(codes.begin(), codes.end()));
}

// Of a raster of a wavy surface, away from its rim: half the distance, a quarter of the angle.
TEST(Sites, AxesAreNormalsAndErrorsFallWithTheSquareOfTheDistance) {
  const PointSet cloud = in_order(scan_lines(1, 0));
  double before = 0;
  for (const double distance : {0.02, 0.04, 0.08}) {
    const Sites sites = place_sites(cloud, distance);
    double worst = 0;
    for (std::size_t s = 0; s < sites.size(); ++s) {
      EXPECT_LT(sites.flatness[s], distance * 2);
      const double x = sites.points()[s][0], y = sites.points()[s][1];
      if (std::max(std::abs(x), std::abs(y)) > 0.7) continue;
      const Vec3 normal{-0.25 * std::cos(5 * x) * std::cos(4 * y), 0.2 * std::sin(5 * x) * std::sin(4 * y), 1};
      worst = std::max(worst, std::acos(std::min(1.0, std::abs(vector::dot(sites.axis[s], vector::normalised(normal))))));
    }
    EXPECT_LT(worst, 4.5 * distance * distance) << distance;
    EXPECT_LT(before, worst / 3) << distance;
    before = worst;
  }
}

TEST(Sites, LinesBecomeASurfaceAcrossTheirGaps) {
  for (const double ratio : {1.0, 6.0, 20.0}) {
    const PointSet cloud = in_order(scan_lines(ratio));
    const double distance = surface_distance(cloud);
    if (ratio == 1) {
      EXPECT_EQ(distance, 0);
      continue;
    }
    EXPECT_GT(distance, 0.4 * 0.01 * ratio) << ratio;
    EXPECT_LT(distance, 3 * 0.01 * ratio) << ratio;
    const Sites sites = place_sites(cloud, distance);
    std::size_t upright = 0;
    for (const Vec3& axis : sites.axis) upright += std::abs(axis[2]) > 0.9 ? 1 : 0;
    EXPECT_GT(static_cast<double>(upright), 0.98 * static_cast<double>(sites.points().size())) << ratio;
  }
}

// A square of which one half is lines, ten times as far apart as their points, and the other random points as dense as along a line.
TEST(Sites, LinesHaveTheirDistanceAndTheRestHasNone) {
  shapes::Random random(5);
  std::vector<Vec3> points;
  for (int line = 0; line < 10; ++line) {
    for (int i = 0; i < 100; ++i) points.push_back({-0.95 + 0.1 * line, -0.5 + 0.01 * (i + random.uniform(0, 0.1)), 0});
  }
  for (int i = 0; i < 10000; ++i) points.push_back({random.uniform(0.05, 1.05), random.uniform(-0.5, 0.5), 0});
  const PointSet cloud = in_order(points);
  const std::vector<double> distance = surface_distances(cloud);
  ASSERT_EQ(distance.size(), cloud.size());
  const Sites sites = place_sites(cloud, distance);
  std::vector<std::size_t> points_of(sites.size(), 0);
  for (const std::uint32_t s : sites.site_of) ++points_of[s];
  std::size_t dense = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.points()[i];
    if (p[0] > 0.1) {
      ++dense;
      kept += distance[i] == 0 && sites.points()[sites.site_of[i]] == p ? 1 : 0;
    } else if (p[0] < -0.1) {
      EXPECT_GT(distance[i], 0.03) << p[0];
      EXPECT_LT(distance[i], 0.2) << p[0];
      EXPECT_GT(points_of[sites.site_of[i]], 2U) << p[0];
    }
  }
  EXPECT_GT(static_cast<double>(kept), 0.99 * static_cast<double>(dense));  // few random ones are like lines
  for (const Vec3& axis : sites.axis) EXPECT_GT(std::abs(axis[2]), 0.999);
  EXPECT_TRUE(surface_distances(in_order(shapes::sphere(3000).points)).empty());
}

// Fewer than half of the points are a ball smaller than the gaps, more of them within every reach than are looked at.
TEST(Sites, LinesBesideADenseBallKeepTheirDistance) {
  shapes::Random random(6);
  std::vector<Vec3> points;
  for (double y = -0.9; y < 0.9; y += 0.08) {
    for (double x = -0.9; x < 0.9; x += 0.002)
      points.push_back({x + 0.0002 * random.gaussian(), y, 0.05 * std::sin(5 * x) * std::cos(4 * y)});
  }
  const double alone = surface_distance(in_order(points));
  ASSERT_GT(alone, 0.02);
  for (const Vec3& p : shapes::sphere(points.size() * 2 / 3, 0.005, {0, 0, 0.6}).points) points.push_back(p);
  const double beside = surface_distance(in_order(points));
  EXPECT_GT(beside, alone / 2);
  EXPECT_LT(beside, alone * 2);
}

TEST(Sites, CanBeCancelled) {
  const std::atomic<bool> cancel = true;
  const PointSet cloud = in_order(scan_lines(6));
  EXPECT_THROW(static_cast<void>(surface_distances(cloud, &cancel)), Cancelled);
  EXPECT_THROW(static_cast<void>(place_sites(cloud, 0.05, &cancel)), Cancelled);
}

}  // namespace
}  // namespace g3r
