// The fast sums against their definitions: accuracy over shapes, sizes and tolerances; adjoints to rounding; widths; queries; determinism.
#include "sum/fast_sum.h"

#include "cloud/canonical_cloud.h"
#include "cpu/parallel.h"
#include "shapes.h"
#include "solve/harmonics.h"
#include "sum/direct_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace g3r {
namespace {

using shapes::Random;

struct Case {
  std::string name;
  std::vector<Vec3> points;
};

std::vector<Vec3> unit_points(const std::vector<Vec3>& points) {
  if (points.size() < 4) return points;
  return canonical_cloud(points).points;
}

std::vector<Case> clouds(std::size_t n) {
  std::vector<Case> out;
  Random random(7);
  out.push_back({"sphere", shapes::sphere(n).points});
  out.push_back({"random torus", shapes::torus(n, 0.6, 0.25, 3).points});
  std::vector<Vec3> p;
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::pow(10.0, -4 * random.uniform());
    const Vec3 d = random.direction();
    p.push_back({r * d[0], r * d[1], r * d[2]});
  }
  out.push_back({"clustered", p});
  p.clear();
  for (std::size_t i = 0; i < n; ++i) p.push_back({random.uniform(-1, 1), 1e-3 * random.gaussian(), 1e-3 * random.gaussian()});
  out.push_back({"needle", p});
  p.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 d = random.direction();
    const double side = i % 2 == 0 ? -1 : 1;
    p.push_back({side + 1e-3 * d[0], 1e-3 * d[1], 1e-3 * d[2]});
  }
  out.push_back({"two far clusters", p});
  p.clear();
  for (std::size_t i = 0; i < n; ++i) p.push_back({random.uniform(-1, 1), random.uniform(-1, 1), 0});
  out.push_back({"plane", p});
  for (Case& c : out) c.points = unit_points(c.points);
  return out;
}

std::vector<std::uint64_t> codes(const std::vector<Vec3>& points) {
  std::vector<std::uint64_t> out;
  for (const Vec3& p : points) out.push_back(morton_code(p));
  return out;
}

std::vector<Vec3> random_vectors(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> out(n);
  for (Vec3& v : out) v = random.direction();
  return out;
}

std::vector<double> random_values(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> out(n);
  for (double& v : out) v = random.uniform(-1, 1);
  return out;
}

double norm(const std::vector<double>& a) {
  double sum = 0;
  for (const double v : a) sum += v * v;
  return std::sqrt(sum);
}

std::vector<double> flat(const std::vector<Vec3>& a) {
  std::vector<double> out;
  for (const Vec3& v : a) out.insert(out.end(), v.begin(), v.end());
  return out;
}

double relative_error(std::vector<double> a, const std::vector<double>& truth) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= truth[i];
  return norm(a) / norm(truth);
}
double relative_error(const std::vector<Vec3>& a, const std::vector<Vec3>& truth) { return relative_error(flat(a), flat(truth)); }

double spacing_of(const std::vector<Vec3>& points) { return 1.0 / std::sqrt(static_cast<double>(points.size())); }

// Worst relative error of all sums of one plan on one cloud.
double worst_error(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan) {
  FastSum sum(points, codes(points), widths, plan);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 2), points);
  const std::vector<double> q = random_values(points.size() * u.count, 2);
  const std::vector<double> q1 = random_values(points.size(), 3);
  std::vector<Vec3> s;
  std::vector<double> w;
  sum.stokes_winding(eta, s, w);
  const HarmonicValues one = evaluate_harmonics(harmonics_of_degrees(0, 0), points);
  std::vector<double> w_true = direct_sum::green(points, widths, one, eta);
  for (double& v : w_true) v /= one.value[0];
  std::vector<Vec3> wt_true = direct_sum::green_adjoint(points, widths, one, q1);
  for (Vec3& v : wt_true) {
    for (double& c : v) c /= one.value[0];
  }
  double worst = 0;
  const auto check = [&](const char* name, double error) {
    if (std::getenv("G3R_VERBOSE") != nullptr) std::printf("    %-14s %.2e\n", name, error);
    worst = std::max(worst, error);
  };
  check("green", relative_error(sum.green(u, eta), direct_sum::green(points, widths, u, eta)));
  check("green adjoint", relative_error(sum.green_adjoint(u, q), direct_sum::green_adjoint(points, widths, u, q)));
  check("stokes", relative_error(s, direct_sum::stokes_single_layer(points, widths, eta)));
  check("winding", relative_error(w, w_true));
  check("winding adj", relative_error(sum.winding_adjoint(q1), wt_true));
  if (widths.uniform()) {
    check("gradient", relative_error(sum.winding_gradient(eta), direct_sum::winding_gradient(points, widths[0], eta, points)));
  }
  return worst;
}

TEST(FastSum, ErrorStaysBelowTheAccuracy) {
  for (const std::size_t n : {1UL, 2UL, 9UL, 100UL, 3000UL}) {
    for (const Case& c : clouds(n)) {
      if (n < 4 && c.name != "sphere") continue;
      for (const double accuracy : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
        const SumPlan plan = sum_plan(accuracy, n);  // direct below the crossover
        const double error = worst_error(c.points, Widths(0.4 * spacing_of(c.points)), plan);
        if (std::getenv("G3R_VERBOSE") != nullptr) std::printf("%-18s n=%zu tol=%g error=%.2e\n", c.name.c_str(), n, accuracy, error);
        EXPECT_LE(error, accuracy) << c.name << " n=" << n << " accuracy " << accuracy;
      }
    }
  }
}

}  // namespace
}  // namespace g3r
