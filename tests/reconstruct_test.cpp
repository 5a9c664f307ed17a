// reconstruct() and mesh_oriented(): what they refuse, leave out and do not depend on.
#include <g3r/g3r.h>

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

// A plan of a great cloud takes seconds.
TEST(Reconstruct, StopsBeforeItsPlan) {
  const std::atomic<bool> stop{true};
  Monitor stopped;
  stopped.cancel = &stop;
  Options options;
  options.max_memory = 1;
  EXPECT_THROW(static_cast<void>(reconstruct(shapes::torus(2000, 0.6, 0.25, 1).points, options, {}, stopped)), Cancelled);
}

// Normals are told at any scale; a mesh is refused before the work where its area and volume could not be.
TEST(Reconstruct, RefusesWhatCannotBeMeasured) {
  const Surface s = shapes::sphere(500, 1);
  for (const double scale : {1e60, 1e-71, 1e-150}) {
    std::vector<Vec3> points = s.points;
    for (Vec3& p : points) p = vector::scale(p, scale);
    EXPECT_THROW((void)reconstruct(points), InvalidInput);
    EXPECT_THROW((void)mesh_oriented(points, s.normals), InvalidInput);
    EXPECT_EQ(shapes::share_correct(orient(points).normals, s.normals), 1);
  }
}

// Copies of a point whose normals cancel are like one without a normal: no direction is made up for them. So is a place that no frame holds
// together with the others.
TEST(MeshOriented, LeavesOutWhatHasNoDirectionOrNoPlace) {
  const Surface s = shapes::sphere(2000, 1);
  std::vector<Vec3> points = s.points, normals = s.normals, directed, directions;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (i % 20 == 0) {
      points.push_back(s.points[i]);
      normals.push_back(vector::scale(s.normals[i], -1));
    } else {
      directed.push_back(s.points[i]);
      directions.push_back(s.normals[i]);
    }
  }
  points.push_back({1e30, 2e29, 0});
  normals.push_back({0, 0, 1});
  MeshReport report;
  const Mesh mesh = mesh_oriented(points, normals, {}, {}, &report), expected = mesh_oriented(directed, directions);
  EXPECT_EQ(mesh.vertices, expected.vertices);
  EXPECT_EQ(mesh.triangles, expected.triangles);
  EXPECT_EQ(report.stats.points, 2101U);
  EXPECT_EQ(report.stats.used, 1900U);
  EXPECT_EQ(report.stats.outliers, 1U);
  EXPECT_EQ(report.check.dropped.points, 1U);
  EXPECT_EQ(report.stats.merged_duplicates, 0U);
  ASSERT_FALSE(report.stats.warnings.empty());
  EXPECT_NE(report.stats.warnings.front().find("200 points at places where normals are opposite"), std::string::npos);
}

// Also where points are there five times, with a normal of its own each.
TEST(MeshOriented, DoesNotDependOnTheOrderOfCopies) {
  const Surface s = shapes::sphere(1000, 1);
  shapes::Random random(9);
  std::vector<Vec3> points, normals;
  for (std::size_t copy = 0; copy < 5; ++copy) {
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      points.push_back(s.points[i]);
      normals.push_back(
          vector::normalised(vector::add(s.normals[i], vector::scale({random.normal(), random.normal(), random.normal()}, 0.1))));
    }
  }
  const Mesh mesh = mesh_oriented(points, normals);
  std::reverse(points.begin(), points.end());
  std::reverse(normals.begin(), normals.end());
  EXPECT_EQ(mesh_oriented(points, normals).vertices, mesh.vertices);
}

}  // namespace
}  // namespace g3r
