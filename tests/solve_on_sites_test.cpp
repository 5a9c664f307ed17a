// Scan lines are solved for on sites that are a surface: right sides, and the area of the whole.
#include "orient/solve_on_sites.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

// Circles of latitude of a sphere, with points eight times as close along a circle as the circles are to each other.
shapes::Surface circles(int count) {
  shapes::Surface s;
  shapes::Random random(3);
  const double apart = std::numbers::pi / count;
  for (int k = 0; k < count; ++k) {
    const double latitude = (k + 0.5) * apart;
    const auto along = static_cast<int>(std::ceil(2 * std::numbers::pi * std::sin(latitude) / (apart / 8)));
    const double first = random.uniform(0, 1);
    for (int i = 0; i < along; ++i) {
      const double phi = 2 * std::numbers::pi * (i + first) / along;
      const Vec3 n{std::sin(latitude) * std::cos(phi), std::sin(latitude) * std::sin(phi), std::cos(latitude)};
      s.points.push_back(n);
      s.normals.push_back(n);
    }
  }
  return s;
}

TEST(SolveOnSites, ScanLinesOfASphereFaceOutwards) {
  const shapes::Surface s = circles(40);
  const Problem problem = problems::prepared(s.points);
  ASSERT_GT(problem.line_distance, 0);
  const Monitor monitor;
  Stages stages(monitor);
  Stats stats;
  const Solution found = solve_on_sites(problem, {}, stages, stats);
  const std::vector<Vec3> truth = problems::in_its_order(problem, s.normals);
  ASSERT_EQ(found.eta.size(), truth.size());
  EXPECT_EQ(shapes::share_correct(found.refinement.normals, truth), 1);
  EXPECT_EQ(shapes::share_correct(found.eta, truth), 1);
  EXPECT_TRUE(stats.converged);
  double area = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) area += vector::dot(found.eta[i], truth[i]);
  const double world = 1 / (problem.cloud.frame.scale * problem.cloud.frame.scale);
  EXPECT_NEAR(area * world, 4 * std::numbers::pi, 0.2 * 4 * std::numbers::pi);  // that of every site is shared by its points
}

// The method that is taken by itself, named, is the same run.
TEST(SolveOnSites, IsPartOfTheMethodThatIsNamed) {
  const std::vector<Vec3> points = circles(20).points;
  Options named;
  named.method = Method::kEnergy;
  EXPECT_EQ(orient(points, named).normals, orient(points).normals);
}

}  // namespace
}  // namespace g3r
