// Outliers and uneven density: what is left out, what is not, and that normals do not suffer.
#include "cloud/outliers.h"

#include "cloud/canonical_cloud.h"
#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "shapes.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <cmath>

namespace g3r {
namespace {

constexpr std::size_t kPoints = 6000;

std::size_t flagged(const std::vector<Vec3>& points) {
  const CanonicalCloud cloud = canonical_cloud(points);
  const std::vector<std::uint32_t> near = Neighbours(cloud.points).of_all(17);
  const std::vector<double> local = local_spacing(cloud.points, near);
  return find_outliers(cloud.points, near, local, typical_spacing(local)).size();
}

// Samples of a torus of which the share falls tenfold from one end to the other.
shapes::Surface uneven_torus() {
  const shapes::Surface dense = shapes::torus(4 * kPoints, 0.6, 0.25, 9);
  shapes::Surface uneven;
  shapes::Random random(4);
  for (std::size_t i = 0; i < dense.points.size(); ++i) {
    const double position = (dense.points[i][0] + 0.85) / 1.7;
    if (random.uniform() > std::pow(10.0, -position)) continue;
    uneven.points.push_back(dense.points[i]);
    uneven.normals.push_back(dense.normals[i]);
  }
  return uneven;
}

double share_right(const shapes::Surface& surface, const std::vector<Vec3>& normals) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vec3& a = surface.normals[i];
    const Vec3& b = normals[i];
    right += a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0.8 ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(surface.points.size());
}

TEST(Outliers, SamplesOfASurfaceAreNone) {
  EXPECT_EQ(flagged(shapes::torus(kPoints, 0.6, 0.25, 1).points), 0U);
  EXPECT_LE(flagged(uneven_torus().points), 6U);
}

TEST(Outliers, MostRandomPointsOfTheBoxAre) {
  shapes::Surface surface = shapes::torus(kPoints, 0.6, 0.25, 1);
  const std::size_t extra = kPoints / 20;
  shapes::Random random(3);
  std::vector<Vec3> points = surface.points;
  for (std::size_t i = 0; i < extra; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  EXPECT_GE(flagged(points), extra * 7 / 10);
  const Orientation o = orient(points);
  EXPECT_GE(share_right(surface, o.normals), 0.995);
  EXPECT_EQ(o.stats.outliers + o.stats.used, points.size());
  double confidence = 0;
  for (std::size_t i = kPoints; i < points.size(); ++i) confidence += static_cast<double>(o.confidence[i]) / static_cast<double>(extra);
  EXPECT_LT(confidence, 0.3);
}

TEST(Outliers, RemovedPointsAreNumberedAfterTheOthers) {
  CanonicalCloud cloud = canonical_cloud(shapes::torus(200, 0.6, 0.25, 1).points);
  const CanonicalCloud before = cloud;
  const std::vector<Vec3> removed = remove_points(cloud, {3, 77});
  ASSERT_EQ(cloud.size(), 198U);
  ASSERT_EQ(removed.size(), 2U);
  for (std::size_t i = 0; i < 200; ++i) {
    const std::uint32_t now = cloud.point_of[i];
    EXPECT_EQ(now < 198 ? cloud.points[now] : removed[now - 198], before.points[before.point_of[i]]);
  }
}

TEST(Density, MayFallTenfold) {
  const shapes::Surface surface = uneven_torus();
  EXPECT_GE(share_right(surface, orient(surface.points).normals), 0.999);
}

}  // namespace
}  // namespace g3r
