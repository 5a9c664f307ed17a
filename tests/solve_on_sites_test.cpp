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
  ASSERT_FALSE(problem.line_distance.empty());
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

// A street that a spinning scanner sees: rings on the ground, and a facade beside it that is sampled densely.
shapes::Surface street() {
  shapes::Surface s;
  for (int ring = 0; ring < 24; ++ring) {
    const double radius = 2 * std::pow(1.1, ring);
    for (int i = 0; i < 500; ++i) {
      const double turn = 2 * std::numbers::pi * i / 500;
      const Vec3 p{radius * std::cos(turn), radius * std::sin(turn), 0};
      if (p[1] > 3) continue;
      s.points.push_back(p);
      s.normals.push_back({0, 0, 1});
    }
  }
  shapes::Random random(4);
  for (int i = 0; i < 15000; ++i) {
    s.points.push_back({random.uniform(-4, 4), 3, random.uniform(0, 3)});
    s.normals.push_back({0, -1, 0});
  }
  return s;
}

// Up decides the ground, and the facade hangs together with it. Its points are sites, and keep the exact directions of a plane.
TEST(SolveOnSites, LinesBesideASurfaceShareItsSide) {
  const shapes::Surface s = street();
  Options options;
  options.hints.up = Vec3{0, 0, 1};
  const Orientation found = orient(s.points, options);
  EXPECT_GT(shapes::share_correct(found.normals, s.normals), 0.99);
  EXPECT_GT(found.stats.confidence_mean, 0.9);
  std::size_t exact = 0;
  std::size_t facade = 0;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (s.normals[i][1] == 0 || s.points[i][2] < 0.3) continue;
    ++facade;
    exact += found.normals[i][1] < -1 + 1e-12 ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(exact), 0.99 * static_cast<double>(facade));
}

// A sphere that is sampled in circles above and evenly below.
TEST(SolveOnSites, LinesOnAClosedSurfaceFaceOutwards) {
  shapes::Surface s;
  const auto add = [&s](const shapes::Surface& sphere, double side) {
    for (std::size_t i = 0; i < sphere.points.size(); ++i) {
      if (side * (sphere.points[i][2] - 0.4) < 0) continue;
      s.points.push_back(sphere.points[i]);
      s.normals.push_back(sphere.normals[i]);
    }
  };
  add(circles(20), 1);
  add(shapes::sphere(12000), -1);
  Problem problem = problems::prepared(s.points);
  ASSERT_FALSE(problem.line_distance.empty());
  EXPECT_FALSE(problem.is_lines());
  const Monitor monitor;
  Stages stages(monitor);
  Stats stats;
  const Solution found = solve_with_lines(problem, {}, stages, stats);
  EXPECT_EQ(shapes::share_correct(found.refinement.normals, problems::in_its_order(problem, s.normals)), 1);
}

// The method that is taken by itself, named, is the same run.
TEST(SolveOnSites, IsPartOfTheMethodThatIsNamed) {
  const std::vector<Vec3> points = circles(20).points;
  Options named;
  named.method = Method::kEnergy;
  EXPECT_EQ(orient(points, named).normals, orient(points).normals);
}

// The twelve edges of a cube as round bars, without their ends.
shapes::Surface cube_of_bars(int count, double radius) {
  shapes::Surface s;
  shapes::Random random(6);
  for (int i = 0; i < count; ++i) {
    const auto axis = static_cast<std::size_t>(random.uniform(0, 3));
    const auto corner = [&] { return random.uniform() < 0.5 ? -1.0 : 1.0; };
    const double turn = random.uniform(0, 2 * std::numbers::pi);
    Vec3 n{0, 0, 0};
    n[(axis + 1) % 3] = std::cos(turn);
    n[(axis + 2) % 3] = std::sin(turn);
    Vec3 p = vector::scale(n, radius);
    p[axis] = random.uniform(-1, 1);
    p[(axis + 1) % 3] += corner();
    p[(axis + 2) % 3] += corner();
    s.points.push_back(p);
    s.normals.push_back(n);
  }
  return s;
}

// And not of the cube whose edges they are: half of their points face its inside.
TEST(SolveOnSites, BarsAreNotTheEdgesOfWhatTheyEnclose) {
  for (const int count : {700, 1500}) {
    const shapes::Surface s = cube_of_bars(count, 0.03);
    EXPECT_GT(shapes::share_correct(orient(s.points).normals, s.normals), 0.97) << count;
  }
}

}  // namespace
}  // namespace g3r
