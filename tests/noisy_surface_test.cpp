// Noisy points on their own walls: for which noise, of which points, and that their directions come closer to the truth.
#include "orient/noisy_surface.h"

#include "orient/projection.h"
#include "problems.h"
#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

Problem with_spacings_of_noise(const std::vector<Vec3>& points, double noise, const char* without = "outliers") {
  Options options;
  options.noise = {Length::Unit::kSpacing, noise};
  options.without = without;
  return problems::prepared(points, options);
}

// sigma' = sigma h / R sqrt(72 / (15 pi)) with R in proportion to sqrt(sigma h) halves the variance from one sigma / h on.
TEST(IsProjected, IsWhereThatHalvesTheVarianceOfTheNoise) {
  const std::vector<Vec3> points = shapes::sphere(3000).points;
  const double unit = projected_noise(1, 1);  // sigma' = unit sqrt(sigma h)
  const double least = 2 * unit * unit;
  EXPECT_FALSE(is_projected(with_spacings_of_noise(points, 0.98 * least)));
  EXPECT_TRUE(is_projected(with_spacings_of_noise(points, 1.02 * least)));
  EXPECT_FALSE(is_projected(with_spacings_of_noise(points, 1.02 * least, "projection")));
  EXPECT_FALSE(is_projected(with_spacings_of_noise(points, 0)));
}

// Random points of the sides of a cube from -1 to 1, whose normals face its middle.
Surface room(std::size_t count) {
  shapes::Random random(7);
  Surface s;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t axis = i % 3;
    const double side = i % 2 == 0 ? 1 : -1;
    Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    Vec3 n{0, 0, 0};
    p[axis] = side;
    n[axis] = -side;
    s.points.push_back(p);
    s.normals.push_back(n);
  }
  return s;
}

struct NoisyTorus {
  NoisyTorus() : surface(shapes::torus(6000, 0.6, 0.25, 2)) {
    shapes::scatter(surface, 0.5 * std::sqrt(4 * std::numbers::pi * std::numbers::pi * 0.6 * 0.25 / 6000));
    problem = with_spacings_of_noise(surface.points, 0.5);
    truth = problems::in_its_order(problem, surface.normals);
    solution = problems::solution_of(problem, shapes::disturbed(surface.normals, 0.3));
  }
  shapes::Surface surface;
  Problem problem;
  std::vector<Vec3> truth;
  Solution solution;
  Monitor monitor;
  Stages stages{monitor};
};

// Directions that are off by 30 degrees come from the field of the polished vectors instead, and with a side that most points have all do.
TEST(PolishProjected, BringsNormalsCloserToTheTruth) {
  NoisyTorus torus;
  for (std::size_t i = 0; i < torus.truth.size(); i += 50) {
    Vec3& n = torus.solution.refinement.normals[i];
    n = vector::scale(n, -1);
  }
  const double error = shapes::angle_error(torus.solution.refinement.normals, torus.truth);
  EXPECT_TRUE(polish_projected(torus.problem, {}, torus.stages, torus.solution));
  EXPECT_GT(shapes::share_correct(torus.solution.refinement.normals, torus.truth), 0.999);
  EXPECT_LT(shapes::angle_error(torus.solution.refinement.normals, torus.truth), 0.3 * error);
}

TEST(PolishProjected, LeavesOpenSurfacesAsTheyAre) {
  NoisyTorus torus;
  const std::size_t n = torus.truth.size();
  OpenSurfaces& surfaces = torus.solution.open_surfaces;
  surfaces.part.assign(n, OpenSurfaces::kNone);
  surfaces.certainty.assign(n, 1);
  surfaces.agrees.assign(n, 1);
  surfaces.certified.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (torus.problem.cloud.points()[i][0] < 0) surfaces.part[i] = 0;
  }
  const std::vector<Vec3> before = torus.solution.refinement.normals;
  EXPECT_TRUE(polish_projected(torus.problem, {}, torus.stages, torus.solution));
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_open = surfaces.is_open(i);
    EXPECT_EQ(torus.solution.refinement.normals[i] == before[i], is_open) << i;
    if (is_open) {
      EXPECT_EQ(surfaces.certified[i], 0);
    }
  }
}

TEST(FitNoisySurface, SmoothsDirectionsUnderNoiseOnly) {
  NoisyTorus torus;
  const std::vector<Vec3> before = torus.solution.refinement.normals;
  fit_noisy_surface(torus.problem, torus.stages, torus.solution);
  EXPECT_LT(shapes::angle_error(torus.solution.refinement.normals, torus.truth), 0.2 * shapes::angle_error(before, torus.truth));
  torus.solution.refinement.normals = before;
  fit_noisy_surface(with_noise(torus.problem, 0, {}), torus.stages, torus.solution);
  EXPECT_EQ(torus.solution.refinement.normals, before);
}

// Directions of a smooth surface come from as many points as hide the noise, with no step where another way of fitting ends: at 0.035 the
// noise that no layer shows, at 0.04 the kernels of clean clouds, at 0.128 planes that facets scatter about, at 0.35 the narrowest noisy
// kernels.
TEST(FitNoisySurface, ErrorsOfASphereHaveNoStep) {
  const std::vector<double> of_each_way{0.03, 0.036, 0.05, 0.1, 0.2, 0.4};
  const std::vector<double> sweep{0.01, 0.02, 0.03, 0.0335, 0.0345, 0.035, 0.0355, 0.036, 0.04, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4};
  double before = 1;
  for (const double sigma : kSanitized ? of_each_way : sweep) {
    Surface s = shapes::sphere(10000);
    shapes::scatter(s, sigma * std::sqrt(4 * std::numbers::pi / 10000));
    const double error = shapes::angle_error(orient(s.points).normals, s.normals);
    EXPECT_LT(error, 0.001) << sigma;
    EXPECT_LT(error, 5 * before) << sigma;
    before = error;
  }
}

// A room, seen from a place in it that is known: kernels follow the noise as they do where no place is.
TEST(FitNoisySurface, ErrorsOfARoomWithItsScannerHaveNoStep) {
  const double spacing = std::sqrt(24.0 / 8000);
  Options options;
  options.hints.sensors = {{0.3, 0.2, 0}};
  for (const double sigma : kSanitized ? std::vector<double>{0.1, 0.4} : std::vector<double>{0.05, 0.1, 0.2, 0.3, 0.4}) {
    Surface s = room(8000);
    shapes::scatter(s, sigma * spacing);
    const Orientation found = orient(s.points, options);
    EXPECT_LT(shapes::angle_error(found.normals, s.normals), 0.02) << sigma;
    EXPECT_GT(shapes::share_correct(found.normals, s.normals), 0.998) << sigma;
  }
}

}  // namespace
}  // namespace g3r
