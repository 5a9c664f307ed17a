// Green's third identity on surfaces with known normals: what the discrete operators must reproduce.
#include "sum/direct_sum.h"

#include "sanitized.h"
#include "shapes.h"
#include "solve/harmonics.h"

#include <gtest/gtest.h>

namespace g3r {
namespace {

constexpr double kEpsilonOverSpacing = 0.8;  // smooths single points without blurring the shape

double spacing_of(const shapes::Surface& s) {
  double area = 0;
  for (const double a : s.areas) area += a;
  return std::sqrt(area / static_cast<double>(s.areas.size()));
}

// Root mean square of A[u_k] eta - u_k / 2 over the points and k.
double identity_error(const shapes::Surface& s) {
  const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 2), s.points);
  const std::vector<double> a = direct_sum::green(s.points, Widths(kEpsilonOverSpacing * spacing_of(s)), u, s.eta());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - u.value[i] / 2) * (a[i] - u.value[i] / 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(GreenIdentity, TrueNormalsSolveItWithFirstOrderConvergence) {
  const auto check = [](const char* name, const std::function<shapes::Surface(std::size_t)>& make) {
    const double coarse = identity_error(make(500));
    const double fine = identity_error(make(4500));  // a third of the spacing
    EXPECT_LT(fine, 0.02) << name;
    EXPECT_LT(fine, coarse / 2.25) << name;  // order one would be a factor 3
  };
  check("sphere", [](std::size_t n) { return shapes::sphere(n); });
  if (kSanitized) return;
  check("ellipsoid", [](std::size_t n) { return shapes::ellipsoid(n, 0.9, 0.6, 0.45); });
  check("torus", [](std::size_t n) { return shapes::torus(n); });
}

// Inside the surface the sums give u, outside 0: evaluated through a point set that joins the surface and the probes, which carry nothing.
TEST(GreenIdentity, GivesUInsideAndZeroOutside) {
  shapes::Surface s = shapes::torus(6000);
  const std::size_t n = s.points.size();
  const std::vector<Vec3> inside{{0.6, 0, 0}, {0, -0.62, 0.05}, {0.4, 0.45, -0.08}};
  const std::vector<Vec3> outside{{0, 0, 0}, {0.95, 0.9, 0.3}, {0.1, 0.1, 0.6}};
  for (const auto* probes : {&inside, &outside}) {
    for (const Vec3& p : *probes) {
      s.points.push_back(p);
      s.normals.push_back({0, 0, 0});
      s.areas.push_back(0);
    }
  }
  const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 3), s.points);
  const std::vector<double> a = direct_sum::green(s.points, Widths(0.02), u, s.eta());
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t k = 0; k < u.count; ++k) {
      const std::size_t at = (n + j) * u.count + k;
      EXPECT_NEAR(a[at], j < 3 ? u.value[at] : 0, 2e-3) << j << " " << k;
    }
  }
}

// The paper's Figure 2: a rotation of the sphere is tangential and divergence free. The winding number cannot see it, the other rows can.
TEST(GreenIdentity, TangentialFieldsAreInvisibleToTheWindingNumberOnly) {
  const shapes::Surface s = shapes::sphere(4000);
  std::vector<Vec3> spin(s.points.size());
  for (std::size_t i = 0; i < spin.size(); ++i) spin[i] = {-s.areas[i] * s.points[i][1], s.areas[i] * s.points[i][0], 0};
  const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 2), s.points);
  const std::vector<double> a = direct_sum::green(s.points, Widths(0.8 * spacing_of(s)), u, spin);
  std::vector<double> size(u.count, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) size[i % u.count] += a[i] * a[i];
  for (double& v : size) v = std::sqrt(v / static_cast<double>(s.points.size()));
  EXPECT_LT(size[0], 2e-3);
  EXPECT_GT(size[1], 0.03);  // y
  EXPECT_GT(size[3], 0.03);  // x
}

// Centred at the evaluation point the rows {x, y, z} become the Stokes single layer, which vanishes on the true normals (math.md).
TEST(GreenIdentity, StokesSingleLayerAnnihilatesTheNormals) {
  const auto size = [](std::size_t n, bool tangential) {
    const shapes::Surface s = shapes::sphere(n);
    std::vector<Vec3> eta = s.eta();
    for (std::size_t i = 0; tangential && i < eta.size(); ++i) eta[i] = {-s.areas[i] * s.points[i][1], s.areas[i] * s.points[i][0], 0};
    double sum = 0;
    for (const Vec3& v : direct_sum::stokes_single_layer(s.points, Widths(0.5 * spacing_of(s)), eta))
      sum += v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return std::sqrt(sum / static_cast<double>(n));
  };
  EXPECT_LT(size(4000, false), 0.01);
  EXPECT_LT(size(4000, false), size(500, false) / 2);
  EXPECT_GT(size(4000, true), 0.1);
}

}  // namespace
}  // namespace g3r
