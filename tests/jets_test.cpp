// Normals of smooth regions from quadratic fits: exact on planes, convergent on curved surfaces, left alone where nothing is proven.
#include "orient/jets.h"

#include "base/vector.h"
#include "cloud/neighbours.h"

#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

// Random points of two squares of side 2, at z = height and z = -height; of one square when it is 0.
Surface plate(std::size_t count, double height) {
  shapes::Random random(11);
  Surface s;
  for (std::size_t i = 0; i < count; ++i) {
    const double side = height == 0 || i % 2 == 0 ? 1 : -1;
    s.points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), height * side});
    s.normals.push_back({0, 0, side});
  }
  return s;
}

double unit_sphere_spacing(std::size_t count) { return std::sqrt(4 * std::numbers::pi / static_cast<double>(count)); }

double sphere_error(std::size_t count) {
  const Surface sphere = shapes::sphere(count);
  std::vector<Vec3> normals = shapes::disturbed(sphere.normals, 0.02);
  fit_jets(PointSet(sphere.points), normals);
  return std::sqrt(shapes::angle_error(normals, sphere.normals));  // in proportion to the angle
}

TEST(Jets, ConvergeOnASphereWhateverTheErrorsOfTheNormals) {
  const double coarse = sphere_error(2000);
  const double fine = sphere_error(32000);  // a quarter of the spacing
  EXPECT_LT(coarse, 0.003);
  EXPECT_LT(fine, coarse / 8);  // at least of order 1.5
}

TEST(Jets, AreExactOnAPlane) {
  constexpr std::size_t kCount = 3000;
  const Surface plane = plate(kCount, 0);
  std::vector<Vec3> normals = shapes::disturbed(plane.normals, 0.05);
  fit_jets(PointSet(plane.points), normals);
  std::size_t exact = 0;
  for (const Vec3& n : normals) exact += n[2] > 1 - 1e-12 ? 1 : 0;
  EXPECT_GT(exact, kCount * 95 / 100);
}

// Points of one ring prove its plane, not the surface's slope across it: before the test of breadth they got the plane's normal.
TEST(Jets, LeaveScanLinesAlone) {
  Surface sphere;
  for (int ring = 1; ring < 40; ++ring) {
    const double theta = ring * std::numbers::pi / 40;
    const int count = static_cast<int>(800 * std::sin(theta));  // ten times as dense as the rings
    for (int k = 0; k < count; ++k) {
      const double phi = 2 * std::numbers::pi * k / count;
      sphere.points.push_back({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  std::vector<Vec3> normals = shapes::disturbed(sphere.points, 0.02);
  fit_jets(PointSet(sphere.points), normals);
  EXPECT_LT(shapes::angle_error(normals, sphere.points), 3e-4);  // 2e-4 were there
  EXPECT_LT(shapes::angle_error(orient(sphere.points).normals, sphere.points), 1e-3);
}

TEST(Jets, LeaveNoisyPointsAlone) {
  const std::size_t count = 4000;
  Surface sphere = shapes::sphere(count);
  const double h = unit_sphere_spacing(count);
  shapes::Random random(9);
  for (Vec3& p : sphere.points) {
    for (double& c : p) c += 0.1 * h * random.gaussian();
  }
  const std::vector<Vec3> before = shapes::disturbed(sphere.normals, 0.02);
  std::vector<Vec3> normals = before;
  fit_jets(PointSet(sphere.points), normals);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < count; ++i) changed += normals[i] != before[i] ? 1 : 0;
  EXPECT_LT(changed, count / 100);
}

TEST(Jets, LeaveFewPointsAsTheyAre) {
  const std::vector<Vec3> few{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<Vec3> normals(3, Vec3{0, 0, 1});
  fit_jets(PointSet(few), normals);
  EXPECT_EQ(normals, std::vector<Vec3>(3, Vec3{0, 0, 1}));
}

// The other side's points, whose normals are opposite, take no part.
TEST(Jets, KeepTheSidesOfAThinPlateApart) {
  constexpr std::size_t kCount = 4000;
  const Surface thin = plate(kCount, 0.01);
  const std::vector<Vec3> before = shapes::disturbed(thin.normals, 0.05);
  std::vector<Vec3> normals = before;
  fit_jets(PointSet(thin.points), normals);
  EXPECT_LT(shapes::angle_error(normals, thin.normals), shapes::angle_error(before, thin.normals) / 2);
  for (std::size_t i = 0; i < kCount; ++i) EXPECT_GT(normals[i][2] * thin.normals[i][2], 0.8);
}

// A dome on its flat base, each with random points; the crease between them turns by 90 degrees.
Surface dome(std::size_t count) {
  shapes::Random random(5);
  Surface s;
  for (const Vec3& p : shapes::sphere(count, 1).points) {
    if (p[2] < 0) continue;
    s.points.push_back(p);
    s.normals.push_back(p);
  }
  while (s.points.size() < count) {  // half the area of the dome, so twice as dense
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), 0};
    if (p[0] * p[0] + p[1] * p[1] > 1) continue;
    s.points.push_back(p);
    s.normals.push_back({0, 0, -1});
  }
  return s;
}

// The means of the normals within a distance, as a gradient blurs them.
std::vector<Vec3> blurred(const Surface& s, double reach) {
  std::vector<Vec3> out;
  for (const Vec3& p : s.points) {
    Vec3 sum{0, 0, 0};
    for (std::size_t j = 0; j < s.points.size(); ++j) {
      if (vector::length(vector::subtract(p, s.points[j])) <= reach) sum = vector::add(sum, s.normals[j]);
    }
    out.push_back(vector::normalised(sum));
  }
  return out;
}

struct Crease {
  Surface surface = dome(4000);
  std::vector<Vec3> normals = blurred(surface, 1.5 * unit_sphere_spacing(4000));
  std::vector<std::uint8_t> proven;

  Crease() : proven(fit_jets(PointSet(surface.points), normals)) {}

  [[nodiscard]] std::size_t unproven() const { return static_cast<std::size_t>(std::count(proven.begin(), proven.end(), 0)); }
};

TEST(JetsAtCreases, GivePointsTheNormalOfTheSurfaceThatHoldsThem) {
  const Crease crease;
  std::vector<Vec3> normals = crease.normals;
  fit_jets_at_creases(PointSet(crease.surface.points), crease.proven, normals);
  std::size_t turned = 0;
  double error = 0;
  double blurred_error = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (normals[i] == crease.normals[i]) continue;
    EXPECT_EQ(crease.proven[i], 0);
    ++turned;
    error += 1 - vector::dot(normals[i], crease.surface.normals[i]);
    blurred_error += 1 - vector::dot(crease.normals[i], crease.surface.normals[i]);
  }
  EXPECT_GT(turned, crease.unproven() / 2);
  EXPECT_LT(error, blurred_error / 1000);
}

TEST(JetsAtCreases, LeavePointsThatNoSurfaceHolds) {
  const Crease crease;
  Surface moved = crease.surface;  // those that are not proven, off every surface
  const double h = unit_sphere_spacing(4000);
  for (std::size_t i = 0; i < moved.points.size(); ++i) {
    if (crease.proven[i] == 0) moved.points[i] = vector::add(moved.points[i], vector::scale(moved.normals[i], 0.2 * h));
  }
  std::vector<Vec3> normals = crease.normals;
  fit_jets_at_creases(PointSet(moved.points), crease.proven, normals);
  std::size_t turned = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) turned += normals[i] != crease.normals[i] ? 1 : 0;
  EXPECT_LT(turned, crease.unproven() / 20);
}

TEST(JetsAtCreases, NeedProvenNeighbours) {
  const Crease crease;
  std::vector<Vec3> normals = crease.normals;
  fit_jets_at_creases(PointSet(crease.surface.points), std::vector<std::uint8_t>(normals.size(), 0), normals);
  EXPECT_EQ(normals, crease.normals);
}

}  // namespace
}  // namespace g3r
