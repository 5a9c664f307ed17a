// Points of a surface that were taken for outliers come back; outliers do not.
#include "mesh/regained_points.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr std::size_t kPoints = 4000;
const double kSpacing = std::sqrt(4 * M_PI / kPoints);

double norm(const Vec3& p) { return std::sqrt(vector::dot(p, p)); }

std::vector<Vec3> random_points(std::size_t count, double half_side) {
  shapes::Random random(5);
  std::vector<Vec3> out(count);
  for (Vec3& p : out)
    p = {random.uniform(-half_side, half_side), random.uniform(-half_side, half_side), random.uniform(-half_side, half_side)};
  return out;
}

// regained points: of a sphere all but a cap of six spacings and half of the rest come back, with the normals of the sphere, although there
// are as many outliers within two spacings of it.
TEST(RegainedPoints, SurfaceComesBack) {
  const Surface sphere = shapes::ellipsoid(kPoints, 1, 1, 1);
  std::vector<Vec3> points, normals, strays, truth;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const bool is_lost = i % 2 == 0 || sphere.points[i][2] > std::cos(3 * kSpacing);
    (is_lost ? strays : points).push_back(sphere.points[i]);
    (is_lost ? truth : normals).push_back(sphere.normals[i]);
  }
  for (const Vec3& p : random_points(8 * kPoints, 1.2)) {
    if (std::abs(norm(p) - 1) < 2 * kSpacing && strays.size() < 2 * truth.size()) strays.push_back(p);
  }
  const std::vector<Vec3> found = mesh::normals_of_regained(points, normals, strays);
  std::size_t lost = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    lost += found[i] == Vec3{0, 0, 0} ? 1 : 0;
    if (norm(found[i]) > 0) {
      EXPECT_GT(vector::dot(found[i], truth[i]), 0.95);
    }
  }
  EXPECT_LE(lost, truth.size() / 100);
  for (std::size_t i = truth.size(); i < strays.size(); ++i) {
    // 0.3 of the first spacing at most, which is 1.4 times as large
    if (norm(found[i]) > 0) {
      EXPECT_LT(std::abs(norm(strays[i]) - 1), 0.6 * kSpacing);
    }
  }
}

// regained points: noise of half a spacing keeps few of them away.
TEST(RegainedPoints, NoisySurfaceComesBack) {
  const Surface sphere = shapes::ellipsoid(kPoints, 1, 1, 1);
  shapes::Random random(9);
  std::vector<Vec3> points, normals, strays;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vec3 moved = vector::scale(sphere.points[i], 1 + 0.5 * kSpacing * random.gaussian());
    const bool is_lost = i % 2 == 0 || sphere.points[i][2] > std::cos(3 * kSpacing);
    (is_lost ? strays : points).push_back(moved);
    if (!is_lost) normals.push_back(sphere.normals[i]);
  }
  const std::vector<Vec3> found = mesh::normals_of_regained(points, normals, strays);
  const auto back = std::count_if(found.begin(), found.end(), [](const Vec3& n) { return norm(n) > 0; });
  EXPECT_GE(back, static_cast<std::ptrdiff_t>(8 * strays.size() / 10));  // 0.3 spacings and a standard deviation: 89 %
}

// regained points: outliers that fill a solid, and some of which were taken for points, grow no surface.
TEST(RegainedPoints, OutliersGrowNoSurface) {
  Surface sphere = shapes::ellipsoid(kPoints, 1, 1, 1);
  shapes::Random random(7);
  std::vector<Vec3> strays;
  std::size_t taken = 0;
  for (const Vec3& p : random_points(3 * kPoints, 0.9)) {
    if (norm(p) > 0.9) continue;
    if (taken < 60) {
      sphere.points.push_back(p);
      sphere.normals.push_back(random.direction());
      ++taken;
    } else {
      strays.push_back(p);
    }
  }
  const std::vector<Vec3> found = mesh::normals_of_regained(sphere.points, sphere.normals, strays);
  const auto grown = std::count_if(found.begin(), found.end(), [](const Vec3& n) { return norm(n) > 0; });
  EXPECT_LE(grown, static_cast<std::ptrdiff_t>(strays.size() / 100));
}

TEST(RegainedPoints, FewPointsHaveNoSurface) {
  const std::vector<Vec3> points(5, Vec3{0, 0, 1}), strays(3, Vec3{0, 0, 0});
  for (const Vec3& n : mesh::normals_of_regained(points, points, strays)) EXPECT_EQ(norm(n), 0);
}

}  // namespace
}  // namespace g3r
