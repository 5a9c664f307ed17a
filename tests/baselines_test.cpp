// The earlier methods: their operators are what their headers say, and each orients simple shapes.
#include "base/vector.h"
#include "baselines/gauss_system.h"
#include "baselines/hard_cutoff.h"
#include "baselines/stretched_winding.h"
#include "baselines/wnnc.h"
#include "cloud/canonical_cloud.h"
#include "shapes.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <numbers>

namespace g3r {
namespace {

constexpr std::size_t kCount = 3000;           // above the size where sums are direct
constexpr double kAdjointTolerance = 2e-5;     // float sums (1e-6) and two interpolated tables
constexpr double kDefinitionTolerance = 1e-3;  // of a plan for 1e-4, in the l2 norm

CanonicalCloud bumpy_cloud() {
  const shapes::Surface torus = shapes::torus(kCount, 0.6, 0.25, 5);
  return canonical_cloud(torus.points);
}

std::vector<Vec3> random_vectors(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<Vec3> out(n);
  for (Vec3& v : out) v = random.direction();
  return out;
}

std::vector<double> random_values(std::size_t n, std::uint64_t seed) {
  shapes::Random random(seed);
  std::vector<double> out(n);
  for (double& v : out) v = random.uniform(-1, 1);
  return out;
}

void expect_adjoint(const std::vector<double>& w, const std::vector<Vec3>& wt, const std::vector<Vec3>& eta, const std::vector<double>& q) {
  double forward = 0;
  double backward = 0;
  double size = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    forward += w[i] * q[i];
    size += std::abs(w[i] * q[i]);
    backward += vector::dot(eta[i], wt[i]);
  }
  EXPECT_NEAR(forward, backward, kAdjointTolerance * size);
}

TEST(HardCutoff, SumsOverSourcesBeyondTheWidthOnly) {
  const CanonicalCloud cloud = bumpy_cloud();
  const double width = 0.08;
  HardCutoffSum sum(cloud.points(), width, sum_plan(1e-4, cloud.size()), nullptr);
  const std::vector<Vec3> eta = random_vectors(cloud.size(), 3);
  const std::vector<double> w = sum.winding(eta);
  const std::vector<Vec3> gradient = sum.winding_gradient(eta);
  double error = 0, size = 0, gradient_error = 0, gradient_size = 0;
  for (std::size_t i = 0; i < cloud.size(); i += 10) {
    double wanted = 0;
    Vec3 wanted_gradient{0, 0, 0};
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const Vec3 r = vector::subtract(cloud.points()[j], cloud.points()[i]);
      const double r2 = vector::dot(r, r);
      if (r2 < width * width) continue;
      const double g = 1 / (4 * std::numbers::pi * r2 * std::sqrt(r2));
      wanted += g * vector::dot(r, eta[j]);
      wanted_gradient = vector::add(wanted_gradient, vector::scale(eta[j], g));
      wanted_gradient = vector::subtract(wanted_gradient, vector::scale(r, 3 * g / r2 * vector::dot(r, eta[j])));
    }
    error += (w[i] - wanted) * (w[i] - wanted);
    size += wanted * wanted;
    const Vec3 difference = vector::subtract(gradient[i], wanted_gradient);
    gradient_error += vector::dot(difference, difference);
    gradient_size += vector::dot(wanted_gradient, wanted_gradient);
  }
  EXPECT_LE(std::sqrt(error / size), kDefinitionTolerance);
  EXPECT_LE(std::sqrt(gradient_error / gradient_size), kDefinitionTolerance);
}

TEST(HardCutoff, AdjointIsTheAdjoint) {
  const CanonicalCloud cloud = bumpy_cloud();
  HardCutoffSum sum(cloud.points(), 0.05, sum_plan(1e-2, cloud.size()), nullptr);
  const std::vector<Vec3> eta = random_vectors(cloud.size(), 1);
  const std::vector<double> q = random_values(cloud.size(), 2);
  expect_adjoint(sum.winding(eta), sum.winding_adjoint(q), eta, q);
}

// The winding number of a closed surface is 1/2 on it, in any frame.
TEST(StretchedWinding, IsOneHalfOnAClosedSurface) {
  const shapes::Surface sphere = shapes::sphere(20000, 0.9);
  const CanonicalCloud cloud = canonical_cloud(sphere.points);
  std::vector<Vec3> eta(cloud.size());
  const double area = 4 * std::numbers::pi * 0.909 * 0.909 / static_cast<double>(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) eta[i] = vector::scale(vector::normalised(cloud.points()[i]), area);
  for (const Vec3& stretch : {Vec3{1, 1, 1}, Vec3{3, 1, 1}, Vec3{1, 3, 1}, Vec3{1, 1, 3}}) {
    StretchedWinding winding(cloud.points(), stretch, 0.01, sum_plan(1e-3, cloud.size()), nullptr);
    double mean = 0;
    for (const double w : winding.apply(eta)) mean += w / static_cast<double>(cloud.size());
    EXPECT_NEAR(mean, 0.5, 0.02) << stretch[0] << stretch[1] << stretch[2];
  }
}

TEST(StretchedWinding, AdjointIsTheAdjoint) {
  const CanonicalCloud cloud = bumpy_cloud();
  StretchedWinding winding(cloud.points(), {1, 3, 1}, 0.02, sum_plan(1e-2, cloud.size()), nullptr);
  const std::vector<Vec3> eta = random_vectors(cloud.size(), 1);
  const std::vector<double> q = random_values(cloud.size(), 2);
  expect_adjoint(winding.apply(eta), winding.adjoint(q), eta, q);
}

// But for the sources beyond 8 widths.
TEST(StretchedWinding, RowNormsAreThoseOfTheMatrix) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(300, 0.6, 0.25, 5).points);
  StretchedWinding sum(cloud.points(), {1, 2, 0.5}, 0.1, sum_plan(0, cloud.size()), nullptr);
  std::vector<double> truth(cloud.size(), 0);
  for (std::size_t column = 0; column < 3 * cloud.size(); ++column) {
    std::vector<Vec3> eta(cloud.size(), Vec3{0, 0, 0});
    eta[column / 3][column % 3] = 1;
    const std::vector<double> entries = sum.apply(eta);
    for (std::size_t row = 0; row < truth.size(); ++row) truth[row] += entries[row] * entries[row];
  }
  const std::vector<double> norms = sum.row_norms();
  for (std::size_t row = 0; row < truth.size(); ++row) {
    EXPECT_LE(norms[row], truth[row] * (1 + 1e-5)) << row;
    EXPECT_GE(norms[row], truth[row] * 0.95) << row;
  }
}

TEST(GaussSystem, IsLinearAndSymmetric) {
  const CanonicalCloud cloud = bumpy_cloud();
  GaussSystem system(cloud.points(), {{3, 1, 1}, {1, 1, 1}}, 0.02, 0.05, sum_plan(1e-2, cloud.size()), nullptr);
  const std::vector<Vec3> a = random_vectors(cloud.size(), 1);
  const std::vector<Vec3> b = random_vectors(cloud.size(), 2);
  std::vector<Vec3> sum(a);
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] = vector::add(a[i], vector::scale(b[i], -2));
  const std::vector<Vec3> ma = product_of(system, a);
  const std::vector<Vec3> mb = product_of(system, b);
  const std::vector<Vec3> ms = product_of(system, sum);
  double ab = 0, ba = 0, size = 0, nonlinear = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += vector::dot(a[i], mb[i]);
    ba += vector::dot(b[i], ma[i]);
    size += vector::dot(ms[i], ms[i]);
    const Vec3 difference = vector::subtract(ms[i], vector::add(ma[i], vector::scale(mb[i], -2)));
    nonlinear += vector::dot(difference, difference);
  }
  EXPECT_NEAR(ab, ba, kAdjointTolerance * size);
  EXPECT_LE(nonlinear, kAdjointTolerance * kAdjointTolerance * size);
}

TEST(Baselines, EachOrientsSphereAndTorusAndSaysSo) {
  const shapes::Surface sphere = shapes::sphere(2500);
  const shapes::Surface torus = shapes::torus(3000, 0.6, 0.25, 9);
  for (const auto& [method, name] : {std::pair(Method::kWnnc, "wnnc"), std::pair(Method::kAgr, "agr"), std::pair(Method::kPgr, "pgr")}) {
    Options options;
    options.method = method;
    for (const shapes::Surface* s : {&sphere, &torus}) {
      const Orientation o = orient(s->points, options);
      EXPECT_EQ(shapes::share_correct(o.normals, s->normals), 1) << name;
      EXPECT_TRUE(o.stats.converged) << name;
      EXPECT_EQ(nlohmann::json::parse(report_json(o.stats))["method"]["name"], name);
    }
  }
}

TEST(Baselines, ThreadsAndOrderDoNotChangeTheResult) {
  const shapes::Surface s = shapes::torus(2500, 0.6, 0.25, 9);
  const std::vector<Vec3> reversed(s.points.rbegin(), s.points.rend());
  for (const Method method : {Method::kWnnc, Method::kAgr, Method::kPgr}) {
    Options options;
    options.method = method;
    const std::vector<Vec3> normals = orient(s.points, options).normals;
    options.threads = 1;
    std::vector<Vec3> again = orient(reversed, options).normals;
    std::reverse(again.begin(), again.end());
    EXPECT_EQ(normals, again);
  }
}

TEST(Baselines, WnncWidthsAreThePublishedOnes) {
  EXPECT_EQ(wnnc_widths("clean", 0.01).widest, 0.016);
  EXPECT_EQ(wnnc_widths("noise-0.5", 0.01).narrowest, 0.03);
  EXPECT_DOUBLE_EQ(wnnc_widths("", 0.01).widest, 0.028);
  EXPECT_DOUBLE_EQ(wnnc_widths("density", 0.01).narrowest, 0.0035);
  EXPECT_THROW((void)wnnc_widths("noise", 0.01), InvalidInput);
}

// A width of a hundredth of the spacing: the kernels vanish at every other point, and so does the solution.
TEST(Baselines, NoMeshWithoutAreas) {
  const std::vector<Vec3> points = {{0.3, -1, -0.4}, {-0.1, -0.9, -0.7}, {-0.1, 0.2, -0.1}, {0, -0.9, -0.4}, {0.1, 0.2, -0.2}};
  Options options;
  options.method = Method::kPgr;
  options.epsilon = {Length::Unit::kPercent, 1};
  try {
    (void)reconstruct(points, options);
    FAIL() << "a mesh of nothing";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "no surface found: the orientation gives no point an area");
  }
}

TEST(Baselines, OptionsOfOtherMethodsAreRefused) {
  const shapes::Surface s = shapes::sphere(500);
  const auto refused = [&](const Options& options) { EXPECT_THROW((void)orient(s.points, options), InvalidInput); };
  Options options;
  options.method = Method::kWnnc;
  options.epsilon = {Length::Unit::kSpacing, 1};
  refused(options);
  options.epsilon = {};
  options.schedule = "10 cg";
  refused(options);
  options.schedule = "";
  options.harmonics = "1,x";
  refused(options);
  options.harmonics = "";
  options.method = Method::kPgr;
  options.wnnc_widths = "clean";
  refused(options);
  options.method = Method::kAuto;
  refused(options);
}

}  // namespace
}  // namespace g3r
