// From a problem to area vectors and normals: those of a closed surface add up to nothing, those of an open one stand on it.
#include "orient/solution.h"

#include "base/vector.h"
#include "problems.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

struct SolvedCloud {
  explicit SolvedCloud(const std::vector<Vec3>& points, const Options& given = {}) : problem(problems::prepared(points, given)) {
    const Monitor monitor;
    Stages stages(monitor);
    solution = solve(problem, given, stages, stats);
  }
  Problem problem;
  Stats stats;
  Solution solution;
};

// Gauss: the area vectors of the boundary of a solid add up to 0, and their products with the points to three times its volume.
TEST(Solve, AreaVectorsOfAClosedSurfaceAddUpToNothing) {
  const SolvedCloud ball(shapes::sphere(1500).points);
  const double area = 4 * std::numbers::pi * std::pow(ball.problem.cloud.frame.length_to_unit(0.9), 2);
  Vec3 sum{0, 0, 0};
  double volume = 0;
  for (std::size_t i = 0; i < ball.solution.eta.size(); ++i) {
    sum = vector::add(sum, ball.solution.eta[i]);
    volume += vector::dot(ball.solution.eta[i], ball.problem.cloud.points()[i]) / 3;
  }
  EXPECT_LT(vector::length(sum), 0.01 * area);
  EXPECT_NEAR(volume / (area * ball.problem.cloud.frame.length_to_unit(0.9) / 3), 1, 0.1);
  EXPECT_TRUE(ball.stats.converged);
  EXPECT_FALSE(ball.stats.iterations.empty());
}

TEST(Solve, NormalsAreUnitVectorsOnTheTrueSide) {
  const shapes::Surface torus = shapes::torus(2500, 0.6, 0.25, 2);
  const SolvedCloud solved(torus.points);
  for (const Vec3& n : solved.solution.refinement.normals) EXPECT_NEAR(vector::length(n), 1, 1e-9);
  EXPECT_EQ(shapes::share_correct(solved.solution.refinement.normals, problems::in_its_order(solved.problem, torus.normals)), 1);
}

// A wavy height field has no inside: its area vectors are squares of the spacing along its normals.
TEST(Solve, AreaVectorsOfAnOpenSurfaceStandOnIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) points.push_back({0.04 * i, 0.04 * j, 0.05 * std::sin(0.3 * i) * std::cos(0.25 * j)});
  }
  const SolvedCloud terrain(points);
  const std::vector<double>& spacing = terrain.problem.cloud.set.local_spacing();
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(terrain.solution.open_surfaces.is_open(i)) << i;
    const Vec3& n = terrain.solution.refinement.normals[i];
    EXPECT_NEAR(vector::length(terrain.solution.eta[i]), spacing[i] * spacing[i], 1e-9) << i;
    EXPECT_GT(n[2], 0) << i;  // the side that faces up
  }
}

// The dense solver and conjugate gradients solve the same equations.
TEST(Solve, DenseAndIterativeSolversAgree) {
  Options dense, iterative;
  dense.method = iterative.method = Method::kGreen;
  dense.solver = Solver::kDense;
  iterative.schedule = "200 cg";
  iterative.tolerance = 1e-6;
  iterative.accuracy = 1e-5;
  const std::vector<Vec3> points = shapes::ellipsoid(250, 0.9, 0.7, 0.5).points;
  const SolvedCloud one(points, dense), other(points, iterative);
  double difference = 0, all = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    difference += std::pow(vector::length(vector::subtract(one.solution.eta[i], other.solution.eta[i])), 2);
    all += std::pow(vector::length(one.solution.eta[i]), 2);
  }
  EXPECT_LT(std::sqrt(difference / all), 0.02);
}

}  // namespace
}  // namespace g3r
