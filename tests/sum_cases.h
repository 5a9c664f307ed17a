// Clouds, random densities and every sum of them: what the tests of sums hold against each other.
#pragma once

#include "cloud/canonical_cloud.h"
#include "shapes.h"
#include "solve/harmonics.h"
#include "solve/linear_system.h"
#include "sum/direct_sum.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace g3r::sum_cases {

using shapes::Random;

struct Case {
  std::string name;
  std::vector<Vec3> points;
};

inline std::vector<Vec3> unit_points(const std::vector<Vec3>& points) {
  if (points.size() < 4) return points;
  return canonical_cloud(points).points();
}

inline std::vector<Case> clouds(std::size_t n) {
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

inline std::vector<Vec3> random_vectors(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> out(n);
  for (Vec3& v : out) v = random.direction();
  return out;
}

inline std::vector<double> random_values(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> out(n);
  for (double& v : out) v = random.uniform(-1, 1);
  return out;
}

inline double norm(const std::vector<double>& a) {
  double sum = 0;
  for (const double v : a) sum += v * v;
  return std::sqrt(sum);
}

inline std::vector<double> flat(const std::vector<Vec3>& a) {
  std::vector<double> out;
  for (const Vec3& v : a) out.insert(out.end(), v.begin(), v.end());
  return out;
}

inline double relative_error(std::vector<double> a, const std::vector<double>& truth) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= truth[i];
  return norm(a) / norm(truth);
}
inline double relative_error(const std::vector<Vec3>& a, const std::vector<Vec3>& truth) { return relative_error(flat(a), flat(truth)); }

inline double spacing_of(const std::vector<Vec3>& points) { return 1.0 / std::sqrt(static_cast<double>(points.size())); }

// Every sum over one cloud.
struct Sums {
  std::vector<double> green;
  std::vector<Vec3> green_adjoint;
  std::vector<Vec3> stokes;
  std::vector<double> winding;
  std::vector<Vec3> winding_adjoint;
  std::vector<Vec3> gradient;  // with a uniform width only
};

struct Inputs {
  const std::vector<Vec3>& points;
  Widths widths;
  HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 2), points);
  std::vector<Vec3> eta = random_vectors(points.size(), 1);
  std::vector<double> q = random_values(points.size() * u.count, 2);
  std::vector<double> q1 = random_values(points.size(), 3);

  Inputs(const std::vector<Vec3>& p, Widths w) : points(p), widths(std::move(w)) {}
};

inline Sums direct_sums(const Inputs& in) {
  const HarmonicValues one = evaluate_harmonics(harmonics_of_degrees(0, 0), in.points);
  Sums sums;
  sums.green = direct_sum::green(in.points, in.widths, in.u, in.eta);
  sums.green_adjoint = direct_sum::green_adjoint(in.points, in.widths, in.u, in.q);
  sums.stokes = direct_sum::stokes_single_layer(in.points, in.widths, in.eta);
  sums.winding = direct_sum::green(in.points, in.widths, one, in.eta);
  sums.winding_adjoint = direct_sum::green_adjoint(in.points, in.widths, one, in.q1);
  for (double& v : sums.winding) v /= one.value[0];
  for (Vec3& v : sums.winding_adjoint) {
    for (double& c : v) c /= one.value[0];
  }
  if (in.widths.uniform()) sums.gradient = direct_sum::winding_gradient(in.points, in.widths[0], in.eta, in.points);
  return sums;
}

inline Sums fast_sums(const Inputs& in, const SumPlan& plan) {
  FastSum sum(in.points, in.widths, plan);
  Sums sums;
  sums.green = sum.green(in.u, in.eta);
  sums.green_adjoint = sum.green_adjoint(in.u, in.q);
  sum.stokes_winding(in.eta, sums.stokes, sums.winding);
  sums.winding_adjoint = sum.winding_adjoint(in.q1);
  if (in.widths.uniform()) sums.gradient = sum.winding_gradient(in.eta);
  return sums;
}

inline double worst_error(const Sums& sums, const Sums& truth) {
  const double worst = std::max({relative_error(sums.green, truth.green), relative_error(sums.green_adjoint, truth.green_adjoint),
                                 relative_error(sums.stokes, truth.stokes), relative_error(sums.winding, truth.winding),
                                 relative_error(sums.winding_adjoint, truth.winding_adjoint)});
  return truth.gradient.empty() ? worst : std::max(worst, relative_error(sums.gradient, truth.gradient));
}

// Hides where the vectors of a system could be.
class InMemory : public LinearSystem {
 public:
  explicit InMemory(LinearSystem& system) : system_(system) {}
  void apply(const std::vector<Vec3>& x, std::vector<Vec3>& product) override { system_.apply(x, product); }
  std::vector<Vec3> right_side() override { return system_.right_side(); }

 private:
  LinearSystem& system_;
};

}  // namespace g3r::sum_cases
