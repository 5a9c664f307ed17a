// One try at a problem: what it finds, what it refuses, and what it keeps for the polish on the walls.
#include "orient/attempt.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace g3r {
namespace {

// An attempt at points with these options; normals and areas are in canonical order.
struct Try {
  const std::vector<Vec3>& points;
  Options options;
  Monitor monitor;
  Stages stages{monitor};

  [[nodiscard]] Attempt made() { return attempt(prepare(points, {}, options, stages), points, options, stages); }
};

double share_correct(const Attempt& found, const shapes::Surface& truth) {
  return shapes::share_correct(found.oriented.solution.refinement.normals, problems::in_its_order(found.problem, truth.normals));
}

double angle_error(const Attempt& found, const shapes::Surface& truth) {
  return shapes::angle_error(found.oriented.solution.refinement.normals, problems::in_its_order(found.problem, truth.normals));
}

TEST(Attempt, FindsTheSidesOfATorusAndSaysSo) {
  const shapes::Surface s = shapes::torus(4000, 0.6, 0.25, 2);
  Try torus{s.points, {}, {}};
  const Attempt found = torus.made();
  EXPECT_EQ(share_correct(found, s), 1);
  EXPECT_LT(found.oriented.doubt, 0.01);
  EXPECT_TRUE(found.stats.converged);
  EXPECT_TRUE(found.stats.consistent);
  EXPECT_EQ(found.stats.used, 4000U);
  EXPECT_EQ(found.solved.confidence_mean, 0);  // from before that was known
  EXPECT_GT(found.stats.confidence_mean, 0.9);
}

TEST(Attempt, KeepsOnlyWhatIsNeeded) {
  const shapes::Surface s = shapes::sphere(2000);
  for (const bool from_solution : {false, true}) {
    Try sphere{s.points, {}, {}};
    if (from_solution) sphere.options.without = "areas";
    const Attempt found = sphere.made();
    EXPECT_TRUE(found.oriented.solution.refinement.strength.empty());
    EXPECT_EQ(found.oriented.solution.eta.size(), from_solution ? 2000U : 0U);
  }
}

TEST(Attempt, RefusesBeforeItSolves) {
  const std::vector<Vec3> points = shapes::sphere(2000).points;
  std::vector<std::string> begun;
  const auto note = [&](std::string_view stage, double) {
    begun.emplace_back(stage);
    return true;
  };
  Try refused{points, {}, {note, nullptr}};
  refused.options.max_memory = 1;
  EXPECT_THROW((void)refused.made(), Unavailable);
  for (const std::string& stage : begun) EXPECT_EQ(stage, "build");
}

// A sphere that a sensor in its middle has seen: by the equations it would face outwards.
TEST(Attempt, WhatSensorsHaveSeenFacesThem) {
  const std::vector<Vec3> points = shapes::sphere(4000).points;
  Try seen{points, {}, {}};
  seen.options.hints.sensors = {{0, 0, 0}};
  const Attempt found = seen.made();
  ASSERT_TRUE(found.problem.cloud.set.views().known());
  const Vec3 sensor = found.problem.cloud.frame.to_unit({0, 0, 0});
  for (std::size_t i = 0; i < found.problem.cloud.size(); ++i) {
    EXPECT_GT(vector::dot(found.oriented.solution.refinement.normals[i], vector::subtract(sensor, found.problem.cloud.points()[i])), 0);
  }
}

// Plates of 5 sigma under noise of 0.4 spacings, whose kernels are so wide that they see both walls of one.
TEST(PolishOnWalls, TurnsSidesThatWideKernelsGetWrong) {
  shapes::Surface plates = shapes::plates(3, 0.65, 2, 3, 0.02);
  shapes::scatter(plates, 0.4 * 0.02);
  Try noisy{plates.points, {}, {}};
  noisy.options.noise = {Length::Unit::kInput, 0.4 * 0.02};
  noisy.options.without = "outliers";
  Attempt found = noisy.made();
  EXPECT_EQ(found.oriented.solution.refinement.strength.size(), plates.points.size());  // the polish starts from it
  const double right = share_correct(found, plates);
  const double error = angle_error(found, plates);
  polish_on_walls(found, noisy.options, noisy.stages);
  EXPECT_GT(share_correct(found, plates), right + 0.005);
  EXPECT_LT(angle_error(found, plates), 0.9 * error);
  EXPECT_TRUE(found.oriented.solution.refinement.strength.empty());
  EXPECT_TRUE(found.oriented.solution.eta.empty());
  EXPECT_EQ(found.oriented.confidence.size(), plates.points.size());
}

TEST(PolishOnWalls, LeavesCleanPointsAsTheyAre) {
  const shapes::Surface s = shapes::sphere(2000);
  Try clean{s.points, {}, {}};
  Attempt found = clean.made();
  const std::vector<Vec3> normals = found.oriented.solution.refinement.normals;
  const std::vector<float> confidence = found.oriented.confidence;
  polish_on_walls(found, clean.options, clean.stages);
  EXPECT_EQ(found.oriented.solution.refinement.normals, normals);
  EXPECT_EQ(found.oriented.confidence, confidence);
}

}  // namespace
}  // namespace g3r
