// Normals of outliers go down the winding field of the points.
#include "orient/outlier_normals.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

// The winding number w(x) = sum_i (y_i - x) . eta_i / (4 pi |y_i - x|^3) of points far away.
double winding(const std::vector<Vec3>& points, const std::vector<Vec3>& eta, const Vec3& x) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 r = vector::subtract(points[i], x);
    sum += vector::dot(r, eta[i]) / (4 * std::numbers::pi * std::pow(vector::dot(r, r), 1.5));
  }
  return sum;
}

Vec3 down(const std::vector<Vec3>& points, const std::vector<Vec3>& eta, const Vec3& x) {
  constexpr double kStep = 1e-4;
  Vec3 out{};
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 before = x, after = x;
    before[a] -= kStep;
    after[a] += kStep;
    out[a] = winding(points, eta, before) - winding(points, eta, after);
  }
  return vector::normalised(out);
}

// Half a sphere, of which the field outside is not 0, and points far from it. Under noise of 1.5 spacings it is solved for in groups.
TEST(AddOutliers, TheirNormalsGoDownTheWindingField) {
  shapes::Surface half;
  const shapes::Surface whole = shapes::sphere(4000);
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    if (whole.points[i][2] < 0) continue;
    half.points.push_back(whole.points[i]);
    half.normals.push_back(whole.normals[i]);
  }
  std::vector<Vec3> points = half.points;
  for (const Vec3& far : {Vec3{5, 0, 0}, Vec3{0, -5, 2}, Vec3{1, 1, 6}}) points.push_back(far);
  for (const double noise : {0.0, 1.5}) {
    Options options;
    options.noise = {Length::Unit::kSpacing, noise};
    const Problem problem = problems::prepared(points, options);
    ASSERT_EQ(problem.outliers.size(), 3U) << noise;
    EXPECT_EQ(problem.settings.cluster_side > 0, noise > 0);
    const std::size_t n = problem.cloud.size();
    Solution solution;
    for (const Vec3& p : problem.cloud.points()) {
      const Vec3 normal = vector::normalised(problem.cloud.frame.to_world(p));
      solution.refinement.normals.push_back(normal);
      solution.eta.push_back(vector::scale(normal, problem.spacing * problem.spacing));
    }
    const std::vector<Vec3> eta = solution.eta;
    std::vector<float> confidence(n, 1);
    const Monitor monitor;
    Stages stages(monitor);
    add_outliers(problem, stages, solution, confidence);
    ASSERT_EQ(solution.refinement.normals.size(), n + 3);
    ASSERT_EQ(solution.eta.size(), n + 3);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 expected = down(problem.cloud.points(), eta, problem.outliers[k]);
      EXPECT_GT(vector::dot(solution.refinement.normals[n + k], expected), 0.99) << noise << ' ' << k;
      EXPECT_EQ(solution.eta[n + k], (Vec3{0, 0, 0}));
      EXPECT_EQ(confidence[n + k], 0);
    }
  }
}

TEST(AddOutliers, WithoutAnyNothingChanges) {
  const shapes::Surface s = shapes::sphere(500);
  const Problem problem = problems::prepared(s.points);
  Solution solution = problems::solution_of(problem, s.normals);
  std::vector<float> confidence(500, 1);
  const Monitor monitor;
  Stages stages(monitor);
  add_outliers(problem, stages, solution, confidence);
  EXPECT_EQ(solution.eta.size(), 500U);
  EXPECT_EQ(confidence, std::vector<float>(500, 1));
}

}  // namespace
}  // namespace g3r
