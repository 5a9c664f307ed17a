// Strays: points that no surface goes through, and parts that are no more than chance.
#include "mesh/held_points.h"

#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

std::size_t strays_among(const std::vector<std::uint8_t>& held, std::size_t begin, std::size_t end) {
  return static_cast<std::size_t>(
      std::count(held.begin() + static_cast<std::ptrdiff_t>(begin), held.begin() + static_cast<std::ptrdiff_t>(end), 0));
}

// Points with random normals in a box about the surface, none nearer to the unit sphere than `least`.
void add_random_points(Surface& s, std::size_t count, double least) {
  shapes::Random random(11);
  while (count > 0) {
    const Vec3 p{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
    if (std::abs(std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1) < least) continue;
    s.points.push_back(p);
    s.normals.push_back(random.direction());
    --count;
  }
}

// held points: random ones away from a sphere are strays, nine of ten at the least, and the points of the sphere are none.
TEST(HeldPoints, RandomPointsAreStrays) {
  Surface s = shapes::ellipsoid(5000, 1, 1, 1);
  add_random_points(s, 500, 0.15);  // three spacings
  const std::vector<std::uint8_t> held = mesh::held_points(s.points, s.normals);
  EXPECT_LE(strays_among(held, 0, 5000), 5U);
  EXPECT_GE(strays_among(held, 5000, 5500), 450U);
}

// held points: a part of a cloud, away from where it is cut, is held as it is in the cloud.
TEST(HeldPoints, PartsAreHeldAsInTheCloud) {
  Surface s = shapes::ellipsoid(5000, 1, 1, 1);
  add_random_points(s, 500, 0.15);
  const std::vector<std::uint8_t> held = mesh::held_points(s.points, s.normals);
  const mesh::CloudHeights cloud = mesh::cloud_heights(s.points, s.normals);
  EXPECT_NEAR(cloud.stray_share, 500.0 / 5500, 0.01);
  Surface part;
  std::vector<std::size_t> number;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (s.points[i][0] > 0.7) continue;
    part.points.push_back(s.points[i]);
    part.normals.push_back(s.normals[i]);
    number.push_back(i);
  }
  const std::vector<std::uint8_t> of_part = mesh::held_points(part.points, part.normals, cloud, nullptr);
  for (std::size_t i = 0; i < number.size(); ++i) {
    EXPECT_TRUE(part.points[i][0] > 0 || of_part[i] == held[number[i]]) << i;
  }
  const mesh::CloudHeights noise{cloud.usual, 0.5};
  EXPECT_EQ(strays_among(mesh::held_points(part.points, part.normals, noise, nullptr), 0, part.points.size()), 0U);
}

// held points: creases and corners, noise, and a density that changes tenfold are no reasons.
TEST(HeldPoints, SurfacesAreHeld) {
  shapes::Random random(3);
  Surface cube;
  for (int i = 0; i < 6000; ++i) {
    const auto axis = static_cast<std::size_t>(i % 3);
    Vec3 p{random.uniform(), random.uniform(), random.uniform()};
    Vec3 n{0, 0, 0};
    p[axis] = i % 2;
    n[axis] = i % 2 == 0 ? -1 : 1;
    cube.points.push_back(p);
    cube.normals.push_back(n);
  }
  EXPECT_LE(strays_among(mesh::held_points(cube.points, cube.normals), 0, 6000), 30U);  // of some 600 within a spacing of an edge
  Surface noisy = shapes::ellipsoid(5000, 1, 0.8, 0.6);
  for (Vec3& p : noisy.points) {
    for (double& c : p) c += 0.05 * random.gaussian();  // a spacing
  }
  EXPECT_LE(strays_among(mesh::held_points(noisy.points, noisy.normals), 0, 5000), 5U);
  Surface uneven;
  for (int i = 0; i < 6000; ++i) {
    const double u = random.uniform();
    uneven.points.push_back({std::pow(10, 2 * u), random.uniform() * std::pow(10, 2 * u), 0});  // 1 to 100, ever sparser
    uneven.normals.push_back({0, 0, 1});
  }
  EXPECT_LE(strays_among(mesh::held_points(uneven.points, uneven.normals), 0, 6000), 12U);
}

// held points: where more than a third would be strays the normals are something else, and all points are kept; few points too.
TEST(HeldPoints, NothingIsLeftOfNothing) {
  Surface s = shapes::ellipsoid(2000, 1, 1, 1);
  shapes::Random random(5);
  for (Vec3& n : s.normals) n = random.direction();
  EXPECT_EQ(strays_among(mesh::held_points(s.points, s.normals), 0, 2000), 0U);
  Surface few = shapes::ellipsoid(90, 1, 1, 1);
  add_random_points(few, 9, 0.3);
  EXPECT_EQ(strays_among(mesh::held_points(few.points, few.normals), 0, 99), 0U);
}

// held points: the more strays there are, the more of them look like a part by chance.
TEST(HeldPoints, ChanceGrowsWithTheStrays) {
  EXPECT_EQ(mesh::least_points_of_a_part(0), 0);
  EXPECT_NEAR(mesh::least_points_of_a_part(16), 1 + std::log2(800) / 2, 1e-12);
  EXPECT_NEAR(mesh::least_points_of_a_part(12000), 1 + std::log2(6e5) / 2, 1e-12);
}

// reconstruct: a ball among outliers and a bead beside it come out as two parts, and the report says what was left out; --keep-all keeps
// it.
TEST(HeldPoints, OutliersLeaveNoSurface) {
  if (kSanitized) GTEST_SKIP() << "cli_points_test makes two such meshes";
  Surface s = shapes::ellipsoid(6000, 1, 1, 1);
  const Surface bead = shapes::ellipsoid(60, 0.1, 0.1, 0.1, {1.4, 0, 0});
  s.points.insert(s.points.end(), bead.points.begin(), bead.points.end());
  shapes::Random random(2);
  for (int i = 0; i < 1200; ++i) s.points.push_back({random.uniform(-1.6, 1.6), random.uniform(-1.6, 1.6), random.uniform(-1.6, 1.6)});
  const Reconstruction r = reconstruct(s.points);
  EXPECT_TRUE(r.check.closed);
  EXPECT_EQ(r.check.components, 2U);
  EXPECT_GE(r.check.dropped.points, 900U);
  EXPECT_NEAR(r.check.area, 12.566 + 0.126, 0.4);
  MeshOptions all;
  all.keep_all = true;
  const Reconstruction kept = reconstruct(s.points, {}, all);
  EXPECT_GT(kept.check.components, 2U);
  EXPECT_EQ(kept.check.dropped.components, 0U);
  EXPECT_EQ(kept.check.dropped.points, kept.orientation.stats.outliers);  // the solve has left them out
}

}  // namespace
}  // namespace g3r
