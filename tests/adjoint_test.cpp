// Every forward sum and its adjoint satisfy <A eta, q> = <eta, A^T q> to rounding, although both are approximations.
#include "cloud/canonical_cloud.h"
#include "sanitized.h"
#include "shapes.h"
#include "solve/harmonics.h"
#include "sum/fast_sum.h"

#include <gtest/gtest.h>

namespace g3r {
namespace {

constexpr double kFloatDefect = 1e-6;  // rounding of float sums, relative to |A eta| |q|
constexpr double kDoubleDefect = 1e-12;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i][0] * b[i][0] + a[i][1] * b[i][1] + a[i][2] * b[i][2];
  return sum;
}

class Adjoint : public testing::TestWithParam<std::tuple<double, bool, bool>> {};

TEST_P(Adjoint, HoldsToRounding) {
  const auto [accuracy, direct, local_widths] = GetParam();
  shapes::Random random(11);
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(kSanitized ? 800 : 3000, 0.6, 0.25, 2).points);
  SumPlan plan = sum_plan(accuracy, 1000000);
  plan.leaf_points = 32;
  plan.direct = direct;
  const double limit = plan.double_precision ? kDoubleDefect : kFloatDefect;
  std::vector<double> widths(local_widths ? cloud.size() : 1);
  for (double& w : widths) w = random.uniform(0.005, 0.02);
  FastSum sum(cloud.points(), Widths(widths), plan);
  const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 3), cloud.points());
  std::vector<Vec3> a(cloud.size());
  std::vector<Vec3> b(cloud.size());
  std::vector<double> q(cloud.size() * u.count);
  std::vector<double> q1(cloud.size());
  for (auto* v : {&a, &b}) {
    for (Vec3& x : *v) x = random.direction();
  }
  for (auto* v : {&q, &q1}) {
    for (double& x : *v) x = random.uniform(-1, 1);
  }
  const std::vector<double> forward = sum.green(u, a);
  EXPECT_NEAR(dot(forward, q), dot(a, sum.green_adjoint(u, q)), limit * std::sqrt(dot(forward, forward) * dot(q, q)));
  const std::vector<double> w = sum.winding(a);
  EXPECT_NEAR(dot(w, q1), dot(a, sum.winding_adjoint(q1)), limit * std::sqrt(dot(w, w) * dot(q1, q1)));
  std::vector<Vec3> sa;
  std::vector<Vec3> sb;
  std::vector<double> unused;
  sum.stokes_winding(b, sb, unused);
  sum.stokes_winding(a, sa, unused);  // S is symmetric: its own adjoint
  EXPECT_NEAR(dot(sa, b), dot(a, sb), limit * std::sqrt(dot(sa, sa) * dot(b, b)));
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_NEAR(unused[i], w[i], 2e-3 * std::sqrt(dot(w, w) / static_cast<double>(w.size())));
}

INSTANTIATE_TEST_SUITE_P(Plans, Adjoint, testing::Combine(testing::Values(1e-2, 1e-3, 1e-5), testing::Bool(), testing::Bool()));

TEST(Linearity, SumsOfVectorsAreSumsOfResults) {
  shapes::Random random(3);
  const CanonicalCloud cloud = canonical_cloud(shapes::sphere(kSanitized ? 1000 : 4000).points);
  FastSum sum(cloud.points(), Widths(0.01), sum_plan(1e-5, 1000000));
  std::vector<Vec3> a(cloud.size());
  std::vector<Vec3> b(cloud.size());
  std::vector<Vec3> both(cloud.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = random.direction();
    b[i] = random.direction();
    for (std::size_t k = 0; k < 3; ++k) both[i][k] = 2 * a[i][k] - 3 * b[i][k];
  }
  const std::vector<double> wa = sum.winding(a);
  const std::vector<double> wb = sum.winding(b);
  const std::vector<double> w = sum.winding(both);
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_NEAR(w[i], 2 * wa[i] - 3 * wb[i], 1e-10 * std::sqrt(dot(w, w)));
}

}  // namespace
}  // namespace g3r
