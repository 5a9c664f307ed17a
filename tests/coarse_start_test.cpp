// From 40,000 points on orient() starts from a solution on a quarter of them: fewer steps, and nothing worse.
#include <g3r/g3r.h>

#include "base/vector.h"
#include "sanitized.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

// From 40,000 points on a solution on a quarter of them is the start.
TEST(Orient, CoarseStartsSaveSteps) {
  if (kSanitized) GTEST_SKIP() << "long";
  const Surface s = shapes::join(shapes::sphere(30000, 0.9), shapes::torus(10000, 0.4, 0.15, 4), true);
  Options options;
  const Orientation coarse = orient(s.points, options);
  options.schedule = "45 cg";
  const Orientation direct = orient(s.points, options);
  EXPECT_TRUE(coarse.stats.converged);
  EXPECT_LT(2 * coarse.stats.iterations.size(), direct.stats.iterations.size());
  EXPECT_LE(coarse.stats.iterations.back().residual, coarse.stats.tolerance);
  EXPECT_GT(coarse.stats.tolerance, direct.stats.tolerance);
  EXPECT_EQ(shapes::share_correct(coarse.normals, s.normals), 1);
  EXPECT_LE(shapes::angle_error(coarse.normals, s.normals), 1.1 * shapes::angle_error(direct.normals, s.normals));
  options.schedule.clear();
  options.threads = 3;
  EXPECT_EQ(orient(s.points, options).normals, coarse.normals);
}

// W eta = 1/2 is not true of open surfaces: steps that make it so turn their normals.
TEST(Orient, CoarseStartsSpareOpenSurfaces) {
  if (kSanitized) GTEST_SKIP() << "long";
  const Surface sphere = shapes::sphere(90000);
  Surface half;
  for (std::size_t i = 0; i < sphere.points.size(); ++i) {
    if (sphere.points[i][2] < 0) continue;
    half.points.push_back(sphere.points[i]);
    half.normals.push_back(sphere.normals[i]);
  }
  ASSERT_GT(half.points.size(), 40000U);
  const Orientation o = orient(half.points);
  EXPECT_GE(shapes::share_correct(o.normals, half.normals), 0.999);
  EXPECT_LE(shapes::angle_error(o.normals, half.normals), 0.01);
}

// More steps with the width and the weight of the solve before left 3 % of the sides wrong here.
TEST(Orient, PlatesAreRightFromACoarseStart) {
  const Surface plates = shapes::plates(9, 1, 1.8, 2.7, 0.02);
  ASSERT_GT(plates.points.size(), 40000U);
  EXPECT_GE(shapes::share_correct(orient(plates.points).normals, plates.normals), 0.998);
}

// After a coarse start random points leave a residual that the normals do not show.
TEST(Orient, ASphereOfManyRandomPointsConverges) {
  shapes::Random random(3);
  std::vector<Vec3> points(40000);
  for (Vec3& p : points) {
    for (double& c : p) c = random.gaussian();
    p = vector::scale(p, 1 / std::sqrt(vector::dot(p, p)));
  }
  const Orientation o = orient(points);
  EXPECT_TRUE(o.stats.converged);
  EXPECT_LT(shapes::angle_error(o.normals, points), 1e-3);
}

}  // namespace
}  // namespace g3r
