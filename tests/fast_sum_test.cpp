// The fast sums against their definitions: accuracy over shapes, sizes and tolerances; adjoints to rounding; widths; queries; determinism.
#include "sum/fast_sum.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cpu/parallel.h"
#include "kernels/kernel_polynomials.h"
#include "sanitized.h"
#include "shapes.h"
#include "sum/direct_sum.h"
#include "sum_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace g3r {
namespace {

using namespace sum_cases;  // NOLINT(google-build-using-namespace)
using shapes::Random;

constexpr std::size_t kFew = kSanitized ? 1000 : 2500;  // points that sums to 1e-3 are compared at: the direct ones grow with the square

TEST(FastSum, ErrorStaysBelowTheAccuracy) {
  for (const std::size_t n : {1UL, 2UL, 9UL, 100UL, 2000UL}) {
    for (const Case& c : clouds(n)) {
      if (n < 4 && c.name != "sphere") continue;
      if (kSanitized && n > 1000 && c.name != "needle") continue;  // the direct sums take minutes
      const Inputs in(c.points, Widths(0.4 * spacing_of(c.points)));
      const Sums truth = direct_sums(in);
      for (const double accuracy : {2e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
        const double error = worst_error(fast_sums(in, sum_plan(accuracy, n)), truth);  // direct below the crossover
        EXPECT_LE(error, accuracy) << c.name << " n=" << n;
      }
    }
  }
}

// Errors of random densities grow with the number of points, most on these two.
TEST(FastSum, ErrorStaysBelowTheAccuracyForManyPoints) {
  if (kSanitized) GTEST_SKIP() << "the direct sums take minutes";
  constexpr std::size_t kMany = 4000;
  for (const Case& c : clouds(kMany)) {
    if (c.name != "needle" && c.name != "plane") continue;
    const Inputs in(c.points, Widths(0.4 * spacing_of(c.points)));
    const Sums truth = direct_sums(in);
    for (const double accuracy : {2e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4}) {
      EXPECT_LE(worst_error(fast_sums(in, sum_plan(accuracy, kMany)), truth), accuracy) << c.name;
    }
  }
}

// Four decades of density: those of the dense part dwarf the rest. The truth is the sums to 1e-5, held to that above.
TEST(FastSum, ErrorStaysBelowTheAccuracyForClusteredPoints) {
  if (kSanitized) GTEST_SKIP() << "takes minutes";
  constexpr std::size_t kMany = 10000;
  for (const Case& c : clouds(kMany)) {
    if (c.name != "clustered") continue;
    const Inputs in(c.points, Widths(0.4 * spacing_of(c.points)));
    const Sums truth = fast_sums(in, sum_plan(1e-5, kMany));
    for (const double accuracy : {1e-2, 3e-3, 1e-3, 3e-4}) {
      EXPECT_LE(worst_error(fast_sums(in, sum_plan(accuracy, kMany)), truth), accuracy);
    }
  }
}

// Mollifiers of several spacings: what the far field leaves out of their tails counts most.
TEST(FastSum, ErrorStaysBelowTheAccuracyForWideMollifiers) {
  if (kSanitized) GTEST_SKIP() << "the direct sums take minutes";
  constexpr std::size_t kMany = 4000;
  for (const Case& c : clouds(kMany)) {
    if (c.name != "sphere" && c.name != "needle" && c.name != "plane") continue;
    const Inputs in(c.points, Widths(3 * spacing_of(c.points)));
    const Sums truth = direct_sums(in);
    for (const double accuracy : {2e-2, 1e-2, 3e-3, 1e-3, 3e-4}) {
      EXPECT_LE(worst_error(fast_sums(in, sum_plan(accuracy, kMany)), truth), accuracy) << c.name;
    }
  }
}

TEST(FastSum, PointsMayHaveTheirOwnWidths) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kFew, 0.6, 0.25, 3).points);
  Random random(5);
  std::vector<double> widths(points.size());
  for (double& w : widths) w = random.uniform(0.005, 0.03);
  const Inputs in(points, Widths(widths));
  EXPECT_LE(worst_error(fast_sums(in, sum_plan(1e-3, 1000000)), direct_sums(in)), 1e-3);
}

TEST(FastSum, NarrowerWidthsMayShareATree) {
  const std::vector<Vec3> points = unit_points(shapes::torus(kFew, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const std::vector<double> q = random_values(points.size(), 2);
  Random random(5);
  std::vector<double> local(points.size());
  for (double& w : local) w = random.uniform(0.005, 0.03);
  std::vector<double> half = local;
  for (double& w : half) w *= 0.5;
  const double accuracy = 1e-3;
  const auto fresh = [&](const Widths& widths) { return FastSum(points, widths, sum_plan(accuracy, 1000000)); };
  const auto check = [&](FastSum sum, const Widths& widths) {
    std::vector<Vec3> s;
    std::vector<double> w;
    sum.stokes_winding(eta, s, w);
    EXPECT_LE(relative_error(s, direct_sum::stokes_single_layer(points, widths, eta)), accuracy);
    const std::vector<double> adjoint = flat(sum.winding_adjoint(q));
    EXPECT_NEAR(std::inner_product(w.begin(), w.end(), q.begin(), 0.0),
                std::inner_product(adjoint.begin(), adjoint.end(), flat(eta).begin(), 0.0), 1e-6 * norm(w) * norm(q));
  };
  const FastSum uniform = fresh(Widths(0.03));
  check(FastSum(uniform, Widths(0.01)), Widths(0.01));
  check(FastSum(uniform, Widths(local)), Widths(local));
  const FastSum varied = fresh(Widths(local));
  check(FastSum(varied, Widths(half)), Widths(half));
  check(FastSum(varied, Widths(0.004)), Widths(0.004));
  EXPECT_THROW(FastSum(varied, Widths(0.01)), std::invalid_argument);
  EXPECT_THROW(FastSum(uniform, Widths(0.031)), std::invalid_argument);
}

TEST(FastSum, QueriesSeeTheSameFieldAsThePoints) {
  const std::vector<Vec3> points = unit_points(shapes::torus(4000, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const FastSum sum(points, Widths(0.01), sum_plan(1e-3, 1000000));
  Random random(2);
  std::vector<Vec3> queries;
  for (int i = 0; i < 300; ++i) queries.push_back({random.uniform(-1.3, 1.3), random.uniform(-1, 1), random.uniform(-0.5, 0.5)});
  EXPECT_LE(relative_error(sum.winding_at(eta, queries), direct_sum::winding(points, 0.01, eta, queries)), 1e-3);
  EXPECT_LE(relative_error(sum.winding_gradient_at(eta, queries), direct_sum::winding_gradient(points, 0.01, eta, queries)), 1e-3);
}

TEST(FastSum, QueriesSeeEverySourceWithItsOwnWidth) {
  const std::vector<Vec3> points = unit_points(shapes::torus(4000, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const auto is_wide = [&](std::size_t i) { return points[i][0] > 0; };
  std::vector<double> widths(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) widths[i] = is_wide(i) ? 0.04 : 0.002;
  std::vector<Vec3> queries = points;  // those at a point see its own kernel
  queries.resize(1500);
  for (const bool direct : {false, true}) {
    const FastSum sum(points, Widths(widths), sum_plan(1e-3, direct ? 1 : 1000000));
    std::vector<double> w(queries.size(), 0);
    std::vector<Vec3> gradient(queries.size(), Vec3{0, 0, 0});
    for (const bool wide : {false, true}) {
      std::vector<Vec3> some, of_some;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_wide(i) != wide) continue;
        some.push_back(points[i]);
        of_some.push_back(eta[i]);
      }
      const double width = wide ? 0.04 : 0.002;
      const std::vector<double> part = direct_sum::winding(some, width, of_some, queries);
      const std::vector<Vec3> slope = direct_sum::winding_gradient(some, width, of_some, queries);
      for (std::size_t q = 0; q < queries.size(); ++q) {
        w[q] += part[q];
        gradient[q] = vector::add(gradient[q], slope[q]);
      }
    }
    EXPECT_LE(relative_error(sum.winding_at(eta, queries), w), 1e-3);
    EXPECT_LE(relative_error(sum.winding_gradient_at(eta, queries), gradient), 1e-3);
  }
}

TEST(FastSum, TheFieldsOfSeveralVectorsAreThoseOfEach) {
  const std::vector<Vec3> points = unit_points(shapes::torus(1000, 0.6, 0.25, 3).points);
  const std::vector<std::vector<Vec3>> etas{random_vectors(points.size(), 1), random_vectors(points.size(), 5)};
  const FastSum sum(points, Widths(0.01), sum_plan(2e-2, 1000000));
  const std::vector<Vec3> queries{{0.1, 0.2, 0.3}, {-0.5, 0.4, 0}, {2.5, 0, 1}, {1e9, 0, 0}};  // two outside the cube, one far
  const std::vector<std::vector<double>> w = sum.windings_at(etas, queries);
  ASSERT_EQ(w.size(), 2U);
  for (std::size_t h = 0; h < 2; ++h) EXPECT_EQ(w[h], sum.winding_at(etas[h], queries)) << h;
}

// More than are summed at once, whatever else is asked for.
TEST(FastSum, AQueryHasTheSameBytesAmongMany) {
  const std::vector<Vec3> points = unit_points(shapes::torus(3000, 0.6, 0.25, 3).points);
  const std::vector<Vec3> eta = random_vectors(points.size(), 1);
  const FastSum sum(points, Widths(0.01), sum_plan(2e-2, 1000000));
  Random random(2);
  std::vector<Vec3> queries;
  for (int i = 0; i < 140000; ++i) queries.push_back({random.uniform(-1.3, 1.3), random.uniform(-1, 1), random.uniform(-0.5, 0.5)});
  const std::vector<double> w = sum.winding_at(eta, queries);
  const std::vector<Vec3> gradient = sum.winding_gradient_at(eta, queries);
  for (const std::size_t i : {0UL, 70000UL, 139999UL}) {
    EXPECT_EQ(w[i], sum.winding_at(eta, {queries[i]})[0]) << i;
    EXPECT_EQ(gradient[i], sum.winding_gradient_at(eta, {queries[i]})[0]) << i;
  }
}

TEST(FastSum, QueriesMayBeFarAway) {
  const double width = 0.01;
  const std::vector<Vec3> points = unit_points(shapes::torus(4000, 0.6, 0.25, 3).points);
  std::vector<Vec3> eta = random_vectors(points.size(), 1);
  for (Vec3& v : eta) v = {1 + 0.2 * v[0], 0.5 + 0.2 * v[1], 0.2 * v[2]};  // far away random ones cancel to less than the error allowed
  for (const bool double_precision : {false, true}) {
    SumPlan plan = sum_plan(1e-3, 1000000);
    plan.double_precision = double_precision;
    const FastSum sum(points, Widths(width), plan);
    for (const double far : {1.01, 2.0, 5.0, 1e2, 1e4, 1e8}) {
      if (kSanitized && far != 5.0 && far != 1e8) continue;
      Random random(2);
      std::vector<Vec3> queries;
      for (int i = 0; i < 300; ++i) {
        queries.push_back({far * random.uniform(0.9, 1.0), far * random.uniform(-1, 1), random.uniform(-0.5, 0.5)});
      }
      EXPECT_LE(relative_error(sum.winding_at(eta, queries), direct_sum::winding(points, width, eta, queries)), 1e-3) << far;
      EXPECT_LE(relative_error(sum.winding_gradient_at(eta, queries), direct_sum::winding_gradient(points, width, eta, queries)), 1e-3)
          << far;
    }
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(sum.winding_at(eta, {{0, nothing, 0}})[0]));
  }
}

// The largest relative errors within the reach, over 1/(4 pi), of phi, g, h and b.
template <class T, Precision kPrecision>
std::array<double, 4> polynomial_errors() {
  using P = Polynomials<T, kPrecision>;
  std::array<double, 4> worst{};
  for (int i = 0; i <= 2000; ++i) {
    const double s = kReachSquared<T> * i / 2000, w = kMapScale<T> * s / (s + kMapPole) - 1;
    const KernelValues k = mollified_kernels(s, 1);
    const std::array<double, 4> truth{k.single_layer, k.double_layer, k.stokeslet, k.gradient};
    const std::array<const T*, 4> coefficients{P::kSingleLayer, P::kDoubleLayer, P::kStokeslet, P::kGradient};
    for (std::size_t f = 0; f < 4; ++f) {
      double sum = 0;
      for (int d = P::kDegree; d >= 0; --d) sum = sum * w + static_cast<double>(coefficients[f][d]);
      worst[f] = std::max(worst[f], std::abs(kInv4Pi * sum / truth[f] - 1));
    }
  }
  return worst;
}

TEST(KernelPolynomials, AreAsNearAsIsSaid) {
  const std::array<double, 4> full = polynomial_errors<float, Precision::kFull>();  // coefficients rounded to float count
  const std::array<double, 4> rough = polynomial_errors<float, Precision::kRough>();
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_LT(full[f], 1e-6) << f;
    EXPECT_LT(rough[f], 2.2e-5) << f;
  }
  EXPECT_LT(full[3], 2e-6);  // b is off by more
  EXPECT_LT(rough[3], kRoughPolynomialError);
  for (const double error : polynomial_errors<double, Precision::kFull>()) EXPECT_LT(error, 1e-12);  // that of the definitions
}

}  // namespace
}  // namespace g3r
