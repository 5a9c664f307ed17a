// What a report says of a cloud: every point is counted once, lengths are the caller's, volumes are no surfaces.
#include "orient/describe.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace g3r {
namespace {

Stats described(const std::vector<Vec3>& points, const Options& options = {}) {
  Stats stats;
  describe(problems::prepared(points, options), points, options, stats);
  return stats;
}

TEST(Describe, CountsEveryPointOnce) {
  std::vector<Vec3> points = shapes::sphere(600).points;
  points.push_back(points[7]);
  points.push_back(points[7]);
  points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  points.push_back({40, 0, 0});
  const Stats stats = described(points);
  EXPECT_EQ(stats.points, 604U);
  EXPECT_EQ(stats.used, 600U);
  EXPECT_EQ(stats.merged_duplicates, 2U);
  EXPECT_EQ(stats.dropped_non_finite, 1U);
  EXPECT_EQ(stats.outliers, 1U);
  ASSERT_EQ(stats.warnings.size(), 1U);
  EXPECT_NE(stats.warnings[0].find("non-finite"), std::string::npos);
}

TEST(Describe, LengthsAreInTheUnitsOfThePoints) {
  std::vector<Vec3> points = shapes::sphere(2000, 0.9).points;
  Options options;
  options.noise = {Length::Unit::kSpacing, 0.25};
  const Stats stats = described(points, options);
  EXPECT_NEAR(stats.spacing, 0.9 * std::sqrt(4 * std::numbers::pi / 2000), 0.05 * stats.spacing);
  EXPECT_NEAR(stats.box_side, 1.8, 0.01);
  EXPECT_NEAR(stats.noise, 0.25 * stats.spacing, 1e-12);
  for (Vec3& p : points) {
    for (double& c : p) c *= 1024;  // exact
  }
  const Stats larger = described(points, options);
  EXPECT_EQ(larger.spacing, 1024 * stats.spacing);
  EXPECT_EQ(larger.box_side, 1024 * stats.box_side);
  EXPECT_EQ(larger.noise, 1024 * stats.noise);
  EXPECT_EQ(larger.epsilon, 1024 * stats.epsilon);
  EXPECT_EQ(larger.planned_memory_bytes, stats.planned_memory_bytes);
}

// A solve from 0 has wider kernels than one that starts from fewer points, unless the width is given.
TEST(Describe, EpsilonIsThatOfTheSolve) {
  const std::vector<Vec3> few = shapes::sphere(2000).points;
  const std::vector<Vec3> many = shapes::sphere(40'000).points;
  const auto spacings = [](const Stats& stats) { return stats.epsilon / stats.spacing; };
  EXPECT_NEAR(spacings(described(few)), 0.5, 1e-9);
  EXPECT_NEAR(spacings(described(many)), 0.4, 1e-9);
  Options options;
  options.epsilon = {Length::Unit::kSpacing, 0.45};
  EXPECT_NEAR(spacings(described(few, options)), 0.45, 1e-9);
}

// The sphere's box is 1.8 wide: erf(1.8 / (2 sqrt(2) e)) cubed is a half for e = 0.711.
TEST(Describe, AGivenEpsilonThatHidesTheInsideIsDoubtful) {
  const std::vector<Vec3> points = shapes::sphere(2000, 0.9).points;
  const auto with = [&](double epsilon) {
    Options options;
    options.epsilon = {Length::Unit::kInput, epsilon};
    return described(points, options);
  };
  for (const double epsilon : {0.02, 0.4, 0.7}) {
    EXPECT_FALSE(with(epsilon).doubtful) << epsilon;
    EXPECT_TRUE(with(epsilon).warnings.empty()) << epsilon;
  }
  for (const double epsilon : {0.72, 1.0, 50.0}) {
    const Stats stats = with(epsilon);
    EXPECT_TRUE(stats.doubtful) << epsilon;
    ASSERT_EQ(stats.warnings.size(), 1U) << epsilon;
    EXPECT_NE(stats.warnings[0].find("less than 0.71 "), std::string::npos) << stats.warnings[0];
  }
}

TEST(Describe, AGivenNoiseLargerThanTheCloudIsDoubtful) {
  const std::vector<Vec3> points = shapes::sphere(2000, 0.9).points;
  const auto with = [&](double noise) {
    Options options;
    options.noise = {Length::Unit::kInput, noise};
    return described(points, options);
  };
  EXPECT_FALSE(with(0.1).doubtful);
  EXPECT_TRUE(with(0.1).warnings.empty());
  for (const double noise : {1.9, 1e9}) {
    const Stats stats = with(noise);
    EXPECT_TRUE(stats.doubtful) << noise;
    ASSERT_EQ(stats.warnings.size(), 1U) << noise;
    EXPECT_NE(stats.warnings[0].find("more than all of the cloud is wide"), std::string::npos);
  }
}

// Within so little height no kernels show an inside: a narrow epsilon is not to blame.
TEST(Describe, AnEpsilonAsTheSpacingAsksForIsNeverTooWide) {
  std::vector<Vec3> ground;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) ground.push_back({i * 0.1, j * 0.1, 0.01 * std::sin(i + 0.7 * j)});
  }
  for (const double spacings : {0.5, 2.0}) {
    Options options;
    options.epsilon = {Length::Unit::kSpacing, spacings};
    EXPECT_FALSE(described(ground, options).doubtful) << spacings;
  }
}

// A grid of pixels on a plane that a camera at the origin looks at: what scatters about it is rounding.
TEST(Describe, RoundingIsNoNoiseOfAScanner) {
  std::vector<Vec3> pixels;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      const double u = (i - 30) / 60.0, v = (j - 30) / 60.0;
      const double depth = 3 / (1 + 0.3 * u + 0.2 * v);
      pixels.push_back({u * depth, v * depth, depth});
    }
  }
  Options options;
  options.hints.sensors = {{0, 0, 0}};
  const Problem problem = problems::prepared(pixels, options);
  ASSERT_TRUE(problem.cloud.set.views().known());
  EXPECT_GT(problem.direction_noise, 0);
  EXPECT_EQ(described(pixels, options).noise, 0);
}

TEST(Describe, EarlierMethodsTakeTheirOwnMemory) {
  const std::vector<Vec3> points = shapes::sphere(2000).points;
  Options options;
  options.method = Method::kWnnc;
  const Stats stats = described(points, options);
  EXPECT_EQ(stats.method, "wnnc");
  EXPECT_EQ(stats.harmonics, "1");
  EXPECT_GT(stats.planned_memory_bytes, described(points).planned_memory_bytes);
}

TEST(Describe, OfAPlaneTheOutsideIsAChoiceWhichIsSaidOnce) {
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) points.push_back({static_cast<double>(i), static_cast<double>(j), 3});
  }
  const auto about = [](const Stats& stats, const std::string& word) {
    return std::count_if(stats.warnings.begin(), stats.warnings.end(),
                         [&](const std::string& warning) { return warning.find(word) != std::string::npos; });
  };
  Options options;
  EXPECT_EQ(about(plan(points, options), "flat"), 1);
  const Stats flat = orient(points, options).stats;
  EXPECT_EQ(about(flat, "all in one plane, is the outside is a choice"), 1);
  EXPECT_EQ(about(flat, "flat"), 0);
  options.hints.up = Vec3{0, 0, 1};
  EXPECT_EQ(about(orient(points, options).stats, "choice"), 0);
  options = {};
  options.method = Method::kWnnc;  // does not look for open surfaces
  EXPECT_EQ(about(orient(points, options).stats, "flat"), 1);
  points[0][2] = 4;
  EXPECT_TRUE(plan(points).warnings.empty());
}

// As many points in a ball as on its surface, both taken for as noisy.
TEST(WarnOfVolume, IsThatOfABallAndNotOfItsSurface) {
  shapes::Surface sphere = shapes::sphere(6000);
  shapes::Random random(3);
  std::vector<Vec3> ball;
  for (const Vec3& p : sphere.points) ball.push_back(vector::scale(p, std::cbrt(random.uniform())));
  Options options;
  options.noise = {Length::Unit::kSpacing, 2};
  options.without = "outliers";
  shapes::scatter(sphere, 2 * described(sphere.points, options).spacing);
  Stats of_ball, of_sphere, of_clean_ball;
  warn_of_volume(problems::prepared(ball, options), of_ball);
  EXPECT_FALSE(of_ball.consistent);
  EXPECT_EQ(of_ball.warnings.size(), 1U);
  warn_of_volume(problems::prepared(sphere.points, options), of_sphere);
  EXPECT_TRUE(of_sphere.consistent);
  EXPECT_TRUE(of_sphere.warnings.empty());
  options.noise.value = 0;  // who says that there is no noise says that there is a surface
  warn_of_volume(problems::prepared(ball, options), of_clean_ball);
  EXPECT_TRUE(of_clean_ball.consistent);
}

}  // namespace
}  // namespace g3r
