#include "orient/problem.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace g3r {
namespace {

using problems::prepared;

TEST(Prepare, DoesNotDependOnUnitsOrPlace) {
  std::vector<Vec3> points = shapes::sphere(600).points;
  const Problem problem = prepared(points);
  for (Vec3& p : points) {
    for (double& c : p) c *= 1024;  // exact
  }
  const Problem same = prepared(points);
  EXPECT_EQ(same.cloud.points(), problem.cloud.points());
  EXPECT_EQ(same.spacing, problem.spacing);
  EXPECT_EQ(same.noise, problem.noise);
  EXPECT_EQ(same.settings.epsilon.typical(), problem.settings.epsilon.typical());
}

TEST(Prepare, TakesTheNoiseThatIsGiven) {
  Options options;
  options.noise = {Length::Unit::kSpacing, 0.25};
  const Problem problem = prepared(shapes::sphere(600).points, options);
  EXPECT_DOUBLE_EQ(problem.noise, 0.25 * problem.spacing);
  EXPECT_FALSE(problem.is_clean());
  EXPECT_TRUE(prepared(shapes::sphere(600).points).is_clean());
}

TEST(Prepare, LeavesOutPointsThatAreAlone) {
  std::vector<Vec3> points = shapes::sphere(600).points;
  points.push_back({40, 0, 0});
  const Problem problem = prepared(points);
  EXPECT_EQ(problem.cloud.size(), 600U);
  EXPECT_EQ(problem.outliers.size(), 1U);
  EXPECT_NEAR(problem.spacing, prepared(shapes::sphere(600).points).spacing, 1e-9);  // the frame is that of the rest
}

// Points around a place where the cloud has been thinned are no outliers, and the spacing is that of the rest.
TEST(Prepare, KnowsWhereTheCloudHasBeenThinned) {
  const std::vector<Vec3> dense = shapes::torus(20000, 0.6, 0.25, 2).points;
  std::vector<Vec3> points;
  Known known;
  for (std::size_t i = 0; i < dense.size(); ++i) {
    const bool thinned = dense[i][0] > -0.2;
    if (thinned && i % 64 != 0) continue;
    points.push_back(dense[i]);
    known.relative_spacing.push_back(thinned ? 8 : 1);
  }
  const Monitor monitor;
  Stages stages(monitor);
  const Problem problem = prepare(points, known, {}, stages);
  const Problem unaware = prepare(points, {}, {}, stages);
  EXPECT_GT(unaware.outliers.size(), 10U);
  EXPECT_LE(problem.outliers.size(), 1U);
  EXPECT_NEAR(problem.spacing, prepared(dense).spacing, 0.05 * problem.spacing);
}

// Also by plan(), before anything is read of them.
TEST(Prepare, RefusesSensorsThatDoNotGoWithThePoints) {
  const std::vector<Vec3> points = shapes::sphere(600).points;
  Options options;
  options.hints.sensors = {{3, 0, 0}};
  options.hints.sensor_of_point.assign(601, 0);
  EXPECT_THROW((void)plan(points, options), InvalidInput);
  options.hints.sensor_of_point.assign(600, 1);
  EXPECT_THROW((void)plan(points, options), InvalidInput);
  options.hints.sensor_of_point.assign(600, 0);
  EXPECT_NO_THROW((void)plan(points, options));
}

// Points at one place may name different sensors, in any order.
TEST(SensorsOfPoints, OfDuplicatesTheSmallestCounts) {
  std::vector<Vec3> points = shapes::sphere(600).points;
  points.insert(points.end(), points.begin(), points.begin() + 100);
  std::vector<std::uint32_t> sensors(points.size(), 2);
  for (std::size_t i = 0; i < 100; ++i) sensors[i] = 0, sensors[600 + i] = 1;
  const CanonicalCloud cloud = canonical_cloud(points);
  const std::vector<std::uint32_t> of_points = sensors_of_points(cloud, sensors);
  ASSERT_EQ(of_points.size(), 600U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(of_points[cloud.point_of[i]], 0U);
    std::swap(sensors[i], sensors[600 + i]);
  }
  EXPECT_EQ(sensors_of_points(cloud, sensors), of_points);
}

TEST(Prepare, RefusesTooFewPoints) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)prepared({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {kNan, 0, 0}}), InvalidInput);
}

TEST(WithNoise, ChangesTheNoiseAndNothingOfTheCloud) {
  const Problem problem = prepared(shapes::sphere(600).points);
  const Problem noisy = with_noise(problem, problem.spacing, {});
  EXPECT_EQ(noisy.noise, problem.spacing);
  EXPECT_EQ(noisy.cloud.points(), problem.cloud.points());
  EXPECT_EQ(noisy.spacing, problem.spacing);
  EXPECT_GT(noisy.settings.epsilon.typical(), problem.settings.epsilon.typical());
  EXPECT_EQ(with_noise(problem, 0, {}).settings.epsilon.typical(), problem.settings.epsilon.typical());
}

// Parts and sites of a cloud are among its outliers, which the settings go by.
TEST(OnSites, KnowsTheOutliersOfTheCloud) {
  Problem problem = prepared(shapes::sphere(600).points);
  problem.outlier_share = 0.1;
  const Problem on = on_sites(problem, place_sites(problem.cloud.set, 1.5 * problem.spacing), {});
  EXPECT_EQ(on.outlier_share, 0.1);
  EXPECT_EQ(part_of(problem, {0, 100, 200, 300, 400, 500}, {}).outlier_share, 0.1);
}

TEST(PartOf, IsTheWholeOfAllPointsAndHasTheirPlacesOfSome) {
  const Problem problem = prepared(shapes::sphere(600).points);
  std::vector<std::uint32_t> all, third;
  for (std::uint32_t i = 0; i < 600; ++i) {
    all.push_back(i);
    if (i % 3 == 0) third.push_back(i);
  }
  const Problem whole = part_of(problem, all, {});
  EXPECT_EQ(whole.cloud.points(), problem.cloud.points());
  EXPECT_EQ(whole.settings.epsilon.typical(), problem.settings.epsilon.typical());
  const Problem part = part_of(problem, third, {});
  ASSERT_EQ(part.cloud.size(), 200U);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(part.cloud.points()[i], problem.cloud.points()[3 * i]);
  EXPECT_EQ(part.noise, problem.noise);
  EXPECT_GT(part.spacing, problem.spacing);
}

}  // namespace
}  // namespace g3r
