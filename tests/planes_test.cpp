// Normals of flat facets: exact on narrow ones, at creases and on both sides of thin walls; left alone where no plane is proven.
#include "orient/planes.h"

#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

struct Fitted {
  std::vector<Vec3> normals;
  std::vector<std::uint8_t> proven;
};

Fitted fit(const Surface& surface, std::vector<Vec3> normals, std::uint8_t proven = 0) {
  const std::size_t n = surface.points.size();
  Fitted out{std::move(normals), std::vector<std::uint8_t>(n, proven)};
  fit_planes(PointSet(surface.points), 0, out.proven, out.normals);
  return out;
}

std::vector<Vec3> fitted(const Surface& surface, const std::vector<Vec3>& normals) { return fit(surface, normals).normals; }

double share_exact(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  std::size_t exact = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3& n = normals[i];
    exact += n[0] * truth[i][0] + n[1] * truth[i][1] + n[2] * truth[i][2] > 1 - 1e-8 ? 1 : 0;
  }
  return static_cast<double>(exact) / static_cast<double>(truth.size());
}

// How many differ by more than `degrees`.
std::size_t turned(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double degrees) {
  std::size_t count = 0;
  const double least = std::cos(degrees * std::numbers::pi / 180);
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i][0] * b[i][0] + a[i][1] * b[i][1] + a[i][2] * b[i][2] < least ? 1 : 0;
  return count;
}

// Bars, every point of which is nearer to a crease than to most of its neighbours: what is not exact has too few points on its facet.
TEST(Planes, AreFoundOnFacetsASpacingOrTwoWide) {
  constexpr double kSpacing = 0.02;
  for (const double thickness : {2.0, 4.0, 50.0}) {  // spacings
    const Surface bars = shapes::plates(3, 1, thickness, 5, kSpacing);
    const std::vector<Vec3> normals = fitted(bars, shapes::disturbed(bars.normals, 0.3));
    EXPECT_GT(share_exact(normals, bars.normals), 0.95) << thickness;
    EXPECT_GT(shapes::share_correct(normals, bars.normals), 0.995) << thickness;
  }
}

// Walls a twentieth of a spacing thick, whose points have as many neighbours on the other side.
TEST(Planes, TellTheSidesOfAThinWallApart) {
  constexpr double kSpacing = 0.02;
  const Surface wall = shapes::plates(1, 1, 0.05, 5, kSpacing);
  const std::vector<Vec3> normals = fitted(wall, shapes::disturbed(wall.normals, 0.3));
  EXPECT_GT(share_exact(normals, wall.normals), 0.98);
}

TEST(Planes, AreNotFoundAmongRoughPoints) {
  Surface rough = shapes::sphere(8000);
  const double spacing = 0.9 * std::sqrt(4 * std::numbers::pi / 8000);
  shapes::scatter(rough, 0.2 * spacing);
  EXPECT_LT(turned(fitted(rough, rough.normals), rough.normals, 0.1), 80);
}

// Contours of a rough body in 60 parallel slices, four times as dense along as across: their planes are across the surface.
TEST(Planes, AreNotThoseOfSlices) {
  constexpr int kSlices = 60;
  Surface body;
  for (int slice = 0; slice < kSlices; ++slice) {
    const double z = (slice + 0.5) * 2 / kSlices - 1;
    const auto radius = [z](double phi) { return std::sqrt(1 - z * z) * (1 + 0.15 * std::cos(9 * phi + 4 * z)); };
    const int count = static_cast<int>(2 * std::numbers::pi * 4 * kSlices / 2 * std::sqrt(1 - z * z));
    for (int k = 0; k < count; ++k) {
      const double phi = 2 * std::numbers::pi * k / count;
      const double r = radius(phi);
      const double r_phi = -std::sqrt(1 - z * z) * 0.15 * 9 * std::sin(9 * phi + 4 * z);
      const double r_z = -z / (1 - z * z) * r - std::sqrt(1 - z * z) * 0.15 * 4 * std::sin(9 * phi + 4 * z);
      const Vec3 n{r * std::cos(phi) + r_phi * std::sin(phi), r * std::sin(phi) - r_phi * std::cos(phi), -r * r_z};
      const double size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      body.points.push_back({r * std::cos(phi), r * std::sin(phi), z});
      body.normals.push_back({n[0] / size, n[1] / size, n[2] / size});
    }
  }
  const Orientation o = orient(body.points);
  EXPECT_GT(shapes::share_correct(o.normals, body.normals), 0.995);
  EXPECT_LT(shapes::angle_error(o.normals, body.normals), 5e-3);
}

// A pipe in rings half a radius apart, seen by its rings of 20 points and more: the planes of whole rings hold no line, but no facet
// either.
TEST(Planes, AreNotThoseOfRings) {
  for (const int rings : {10, 12, 16}) {
    Surface pipe;
    for (int ring = 0; ring < rings; ++ring) {
      const double y = 6.0 * ring / (rings - 1);
      for (int k = 0; k < 300; ++k) {
        const double phi = 2 * std::numbers::pi * k / 300;
        pipe.points.push_back({std::cos(phi) + 0.3 * std::sin(y), y, std::sin(phi)});
        pipe.normals.push_back({std::cos(phi), 0, std::sin(phi)});
      }
    }
    EXPECT_EQ(shapes::share_correct(orient(pipe.points).normals, pipe.normals), 1) << rings;
  }
}

// Rows five times as dense along as across, as scanners make them: every row lies in a plane across the surface.
TEST(Planes, AreNotThoseOfRowsAcrossACurvedSurface) {
  constexpr double kAlong = 0.004;
  constexpr double kAcross = 0.02;
  Surface waves;
  shapes::Random random(8);
  for (double x = -0.5; x < 0.5; x += kAcross) {
    for (double y = -0.5; y < 0.5; y += kAlong) {
      const double v = y + kAlong * random.uniform();
      waves.points.push_back({x, v, 0.05 * std::sin(20 * x) * std::cos(20 * v)});
      Vec3 n{-std::cos(20 * x) * std::cos(20 * v), std::sin(20 * x) * std::sin(20 * v), 1};
      const double size = std::hypot(n[0], n[1], n[2]);
      for (double& c : n) c /= size;
      waves.normals.push_back(n);
    }
  }
  EXPECT_LT(turned(fitted(waves, waves.normals), waves.normals, 5), waves.points.size() / 100);
}

TEST(Planes, LeaveProvenPointsAndFewPointsAsTheyAre) {
  const Surface wall = shapes::plates(1, 1, 5, 5, 0.1);
  const std::vector<Vec3> before = shapes::disturbed(wall.normals, 0.1);
  EXPECT_EQ(fit(wall, before, 1).normals, before);
  const Fitted found = fit(wall, before);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(found.proven[i] != 0, found.normals[i] != before[i]);
  const Surface few{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, std::vector<Vec3>(4, Vec3{0, 0.6, 0.8}), {}};
  EXPECT_EQ(fitted(few, few.normals), few.normals);
}

}  // namespace
}  // namespace g3r
