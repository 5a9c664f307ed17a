// Green's third identity on surfaces with known normals: what the discrete operators must reproduce.
#include "sum/direct_sum.h"

#include "kernels/kernels.h"
#include "sanitized.h"
#include "shapes.h"
#include "solve/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

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

// Phi, g, b and h are one kernel and its derivatives, also where the series ends; beyond the reaches they are the plain ones (math.md).
TEST(Kernels, AreDerivativesOfOneAnother) {
  for (const double e : {0.02, 1.0, 7.0}) {
    for (const double widths : {1e-3, 0.1, 0.4999, 0.5001, 1.0, 2.5, 6.0}) {
      const double rho = widths * e, step = 1e-4 * rho;
      const KernelValues k = mollified_kernels(rho * rho, e);
      const KernelValues less = mollified_kernels((rho - step) * (rho - step), e), more = mollified_kernels((rho + step) * (rho + step), e);
      const double slope = 2 * step * rho;
      if (widths > 0.05) {  // where rounding of the differences does not count
        EXPECT_NEAR((less.single_layer - more.single_layer) / slope / k.double_layer, 1, 1e-6) << widths;
        EXPECT_NEAR((less.double_layer - more.double_layer) / slope / k.gradient, 1, 1e-6) << widths;
      }
      EXPECT_NEAR((k.double_layer - e * e * k.gradient) / k.stokeslet, 1, 1e-10) << widths;
      EXPECT_NEAR((4 * k.single_layer) / (3 * (k.single_layer + e * e * k.double_layer) + rho * rho * k.stokeslet), 1, 1e-12) << widths;
    }
  }
  const KernelValues at_0 = mollified_kernels(0, 1);
  const double c = kInv4Pi * std::sqrt(2 / std::numbers::pi);
  EXPECT_DOUBLE_EQ(at_0.single_layer, c);
  EXPECT_DOUBLE_EQ(at_0.double_layer, c / 3);
  EXPECT_DOUBLE_EQ(at_0.gradient, c / 5);
  EXPECT_DOUBLE_EQ(at_0.stokeslet, 2 * c / 15);
  for (const auto& [reach, off] : {std::pair{4.0, 7e-3}, {5.0, 1.5e-4}, {7.0, 2.3e-9}}) {
    const KernelValues k = mollified_kernels(reach * reach, 1);
    EXPECT_NEAR(k.gradient / (3 * kInv4Pi / std::pow(reach, 5)), 1, off) << reach;
    EXPECT_NEAR(k.double_layer / (kInv4Pi / std::pow(reach, 3)), 1, off) << reach;
    EXPECT_NEAR(k.single_layer / (kInv4Pi / reach), 1, off) << reach;
  }
}

}  // namespace
}  // namespace g3r
