// What a mesh is made of: points with normals, without those that no surface goes through.
#include "field/surface_points.h"

#include "base/vector.h"
#include "field/points_with_normals.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace g3r {
namespace {

constexpr std::size_t kOfSphere = 3000;

// points with normals: unit ones; points without a place or a direction are counted, and those too far away are listed.
TEST(PointsWithNormals, WhatHasNoneIsLeftOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const shapes::Surface sphere = shapes::ellipsoid(kOfSphere, 1, 1, 1);
  std::vector<Vec3> points = sphere.points, normals;
  for (const Vec3& n : sphere.normals) normals.push_back(vector::scale(n, 7));
  const Vec3 far{1e9, 0, 0};
  points.insert(points.end(), {{kNan, 0, 0}, {0, 0, 3}, {0, 3, 0}, far});
  normals.insert(normals.end(), {{0, 0, 0}, {0, 0, 0}, {0, kNan, 1}, {1, 0, 0}});
  const PointsWithNormals given = with_normals(points, normals);
  EXPECT_EQ(given.points, sphere.points);
  EXPECT_EQ(given.non_finite, 1U);
  EXPECT_EQ(given.undirected, 2U);
  EXPECT_EQ(given.far, std::vector<Vec3>{far});
  ASSERT_EQ(given.normals.size(), given.points.size());
  for (std::size_t i = 0; i < given.normals.size(); ++i) EXPECT_GT(vector::dot(given.normals[i], sphere.normals[i]), 1 - 1e-12);
}

// points of surfaces: those of a sphere that were taken for strays come back, with area vectors as long as their neighbours'; one far off
// goes, and the frame is that of the sphere.
TEST(SurfacePoints, AreThoseOfTheSphereInItsFrame) {
  shapes::Surface sphere = shapes::ellipsoid(kOfSphere, 1, 1, 1);
  const double scale = canonical_cloud(sphere.points).frame.scale;
  std::vector<Vec3> lost(sphere.points.end() - 20, sphere.points.end());
  sphere.points.resize(kOfSphere - lost.size());
  sphere.normals.resize(sphere.points.size());
  sphere.points.push_back({50, 0, 0});
  sphere.normals.push_back({1, 0, 0});
  OrientedCloud oriented = oriented_cloud(sphere.points, sphere.normals);
  for (Vec3& p : lost) p = oriented.cloud.frame.to_unit(p);
  std::sort(lost.begin(), lost.end());
  std::vector<Vec3> strays = lost;
  keep_surface_points(oriented, strays, nullptr);
  EXPECT_EQ(oriented.cloud.size(), kOfSphere);
  ASSERT_EQ(strays.size(), 1U);
  EXPECT_NEAR(oriented.cloud.frame.to_world(strays[0])[0], 50, 1e-9);
  EXPECT_NEAR(oriented.cloud.frame.scale / scale, 1, 1e-3);
  ASSERT_EQ(oriented.eta.size(), kOfSphere);
  const std::vector<Vec3> directions = directions_of(oriented.eta);
  double area = 0;
  for (std::size_t i = 0; i < kOfSphere; ++i) {
    EXPECT_GT(vector::dot(directions[i], vector::normalised(oriented.cloud.frame.to_world(oriented.cloud.points()[i]))), 0.95);
    area += vector::length(oriented.eta[i]);
  }
  constexpr double kAreas = 0.1;  // what areas of random points err by, all together
  EXPECT_NEAR(area / (scale * scale) / (4 * M_PI), 1, kAreas);
  EXPECT_EQ(oriented.spacing, oriented.cloud.set.spacing());
}

// directions: where areas cancel there is none, and any will do.
TEST(SurfacePoints, PointsWithoutAreaHaveADirection) { EXPECT_EQ(directions_of({{0, 0, 0}}), (std::vector<Vec3>{{0, 0, 1}})); }

}  // namespace
}  // namespace g3r
