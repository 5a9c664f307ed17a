// A solid beside an open surface is solved for as if it were alone.
#include "orient/solve_apart.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// A sphere of radius 0.9 and then a wavy ground `below` its centre.
shapes::Surface sphere_above_ground(double below, double side) {
  shapes::Surface scene = shapes::sphere(1000);
  shapes::Random random(5);
  for (int i = 0; i < 1500; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    scene.points.push_back({side * x, side * y, side * 0.15 * std::sin(5 * x) * std::cos(4 * y) - below});
    scene.normals.push_back({0, 0, 1});
  }
  return scene;
}

// The points of the sphere, in canonical order.
std::vector<std::uint32_t> on_sphere(const Problem& problem) {
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < problem.cloud.size(); ++i) {
    const Vec3 p = problem.cloud.frame.to_world(problem.cloud.points()[i]);
    if (vector::dot(p, p) < 0.9 * 0.9 + 0.01) some.push_back(i);
  }
  return some;
}

TEST(SolveParts, ASolidIsSolvedForWithoutTheGround) {
  const shapes::Surface scene = sphere_above_ground(1.6, 3);
  const Problem problem = problems::prepared(scene.points);
  const std::vector<std::uint32_t> some = on_sphere(problem);
  ASSERT_EQ(some.size(), 1000U);
  const Monitor monitor;
  Stages stages(monitor);
  Stats stats, stats_of_all, stats_alone;
  const Solution found = solve_parts(problem, {}, stages, stats);
  const Solution together = solve(problem, {}, stages, stats_of_all);
  const Solution alone = solve(part_of(problem, some, {}), {}, stages, stats_alone);
  std::size_t other = 0;
  for (std::size_t k = 0; k < some.size(); ++k) {
    EXPECT_EQ(found.eta[some[k]], alone.eta[k]);
    EXPECT_EQ(found.refinement.normals[some[k]], alone.refinement.normals[k]);
    EXPECT_FALSE(found.open_surfaces.is_open(some[k]));
    other += together.eta[some[k]] == alone.eta[k] ? 0 : 1;
  }
  EXPECT_EQ(other, some.size());  // the ground does take part
  EXPECT_TRUE(stats.converged);
  EXPECT_EQ(shapes::share_correct(found.refinement.normals, problems::in_its_order(problem, scene.normals)), 1);
}

// An open surface so far away has no part in the equations, and without one there is nothing to do.
TEST(SolveParts, IsOneSolveWhereNothingDisturbs) {
  shapes::Surface far = sphere_above_ground(25, 0.5);
  for (const std::vector<Vec3>& points : {far.points, shapes::sphere(1000).points}) {
    Options options;
    options.without = "outliers";
    const Problem problem = problems::prepared(points, options);
    const Monitor monitor;
    Stages stages(monitor);
    Stats stats, stats_of_all;
    const Solution found = solve_parts(problem, options, stages, stats);
    const Solution together = solve(problem, options, stages, stats_of_all);
    EXPECT_EQ(found.eta, together.eta);
    EXPECT_EQ(found.refinement.normals, together.refinement.normals);
    EXPECT_EQ(stats.iterations.size(), stats_of_all.iterations.size());
  }
}

// What is not solved for again has converged only if the solve of everything has.
TEST(SolveParts, DoNotConvergeByBeingLeftAlone) {
  Options options;
  options.without = "outliers,more-steps";
  options.schedule = "1 cg";
  options.tolerance = 1e-9;
  const Problem problem = problems::prepared(sphere_above_ground(25, 0.5).points, options);
  const Monitor monitor;
  Stages stages(monitor);
  Stats stats;
  const Solution found = solve_parts(problem, options, stages, stats);
  std::size_t open = 0;
  for (std::size_t i = 0; i < problem.cloud.size(); ++i) open += found.open_surfaces.is_open(i) ? 1 : 0;
  ASSERT_GT(open, 0U);
  ASSERT_LT(open, problem.cloud.size());
  EXPECT_EQ(stats.iterations.size(), 1U);  // nothing was solved for again
  EXPECT_FALSE(stats.converged);
}

}  // namespace
}  // namespace g3r
