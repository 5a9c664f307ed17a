// Normals of clean points: exact where planes hold them, one side for every facet.
#include "orient/clean_surface.h"

#include "base/vector.h"
#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// A plate of random points in planes, with its problem and true normals in canonical order.
struct Plate {
  explicit Plate(double thickness, double scatter = 0) : surface(shapes::plates(1, 1, thickness, 0, 0.02)) {
    shapes::scatter(surface, scatter);
    Options options;
    options.noise = {Length::Unit::kSpacing, 0};
    problem = problems::prepared(surface.points, options);
    normals = problems::in_its_order(problem, surface.normals);
  }
  shapes::Surface surface;
  Problem problem;
  std::vector<Vec3> normals;
};

TEST(FitDirections, AreExactInPlanesAndKeepTheirSides) {
  const Plate plate(10);
  std::vector<Vec3> found = shapes::disturbed(plate.normals, 0.1);
  const std::vector<std::uint8_t> proven = fit_directions(plate.problem, found);
  std::size_t count = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_GT(vector::dot(found[i], plate.normals[i]), 0);
    if (proven[i] == 0) continue;
    ++count;
    EXPECT_GT(vector::dot(found[i], plate.normals[i]), 1 - 1e-6) << i;
  }
  EXPECT_GT(static_cast<double>(count), 0.9 * static_cast<double>(found.size()));
}

TEST(FitDirections, ThatAreLeftOutProveNothing) {
  const Plate plate(10);
  Problem problem = plate.problem;
  problem.settings.without = parse_steps("jets,planes");
  std::vector<Vec3> found = shapes::disturbed(plate.normals, 0.1);
  const std::vector<Vec3> given = found;
  EXPECT_EQ(fit_directions(problem, found), std::vector<std::uint8_t>(given.size(), 0));
  EXPECT_EQ(found, given);
}

// Every twentieth point of a thin plate has the other side than its wall.
TEST(FitCleanSurface, TheFacetsTakeTheSideOfMostOfTheirPoints) {
  const Plate plate(0.8);
  for (const bool has_facets : {true, false}) {
    Problem problem = plate.problem;
    if (!has_facets) problem.settings.without = parse_steps("facets");
    Solution solution = problems::solution_of(problem, plate.surface.normals);
    std::vector<Vec3>& normals = solution.refinement.normals;
    for (std::size_t i = 0; i < normals.size(); i += 20) {
      normals[i] = vector::scale(normals[i], -1);
      solution.eta[i] = vector::scale(solution.eta[i], -1);
    }
    const Monitor monitor;
    Stages stages(monitor);
    fit_clean_surface(problem, solution.eta, normals, stages);
    const double right = shapes::share_correct(normals, plate.normals);
    if (has_facets) {
      EXPECT_GT(right, 0.995);
    } else {
      EXPECT_LT(right, 0.96);
    }
  }
}

// Too few for facets to be solved for: single points, and two side by side.
TEST(FitCleanSurface, SinglePointsTakeTheSideOfTheirFacet) {
  const Plate plate(1.5);
  const Problem& problem = plate.problem;
  Solution solution = problems::solution_of(problem, plate.surface.normals);
  std::vector<Vec3>& normals = solution.refinement.normals;
  const std::size_t one = normals.size() / 2, other = problem.cloud.set.near()[one * problem.cloud.set.near_count() + 1];
  for (const std::size_t i : {one, other}) {
    normals[i] = vector::scale(normals[i], -1);
    solution.eta[i] = vector::scale(solution.eta[i], -1);
  }
  const Monitor monitor;
  Stages stages(monitor);
  fit_clean_surface(problem, solution.eta, normals, stages);
  for (const std::size_t i : {one, other}) {
    EXPECT_GT(vector::dot(normals[i], plate.normals[i]), 0);
    EXPECT_GT(vector::dot(solution.eta[i], plate.normals[i]), 0);
  }
}

// How far an area vector and a normal agree tells the side, so it stays where facets give the normal another direction.
TEST(FitCleanSurface, TurnsAreaVectorsWithTheNormalsAtEdges) {
  const Plate plate(10);
  std::vector<std::vector<double>> cosines;
  std::vector<std::vector<Vec3>> found;
  for (const char* without : {"creases", "creases,facets"}) {
    Problem problem = plate.problem;
    problem.settings.without = parse_steps(without);
    Solution solution = problems::solution_of(problem, plate.surface.normals);
    std::vector<Vec3>& normals = solution.refinement.normals;
    normals = shapes::disturbed(plate.normals, 0.3);
    const Monitor monitor;
    Stages stages(monitor);
    fit_clean_surface(problem, solution.eta, normals, stages);
    cosines.emplace_back();
    for (std::size_t i = 0; i < normals.size(); ++i) {
      cosines.back().push_back(vector::dot(normals[i], solution.eta[i]) / vector::length(solution.eta[i]));
    }
    found.push_back(normals);
  }
  EXPECT_NE(found[0], found[1]);
  EXPECT_LT(shapes::angle_error(found[0], plate.normals), shapes::angle_error(found[1], plate.normals));
  for (std::size_t i = 0; i < cosines[0].size(); ++i) EXPECT_NEAR(cosines[0][i], cosines[1][i], 1e-9) << i;
}

// Facets may be seen to scatter more than what counts as noise where no noise is, and their directions are exact all the same.
TEST(FitCleanSurface, FollowsFacetsThatScatterWhereThereIsNoNoise) {
  const Plate plate(10, 0.06 * 0.02);
  ASSERT_EQ(plate.problem.noise, 0);
  ASSERT_GT(plate.problem.scatter, 0.04 * plate.problem.spacing);
  Solution solution = problems::solution_of(plate.problem, plate.surface.normals);
  std::vector<Vec3>& normals = solution.refinement.normals;
  normals = shapes::disturbed(plate.normals, 0.3);
  const Monitor monitor;
  Stages stages(monitor);
  fit_clean_surface(plate.problem, solution.eta, normals, stages);
  EXPECT_LT(shapes::angle_error(normals, plate.normals), 0.05 * 0.06);
}

}  // namespace
}  // namespace g3r
