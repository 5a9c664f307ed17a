// What hints change of the statistics: contradictions are told, and make a result doubtful where they are in the majority.
#include "orient/apply_hints.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r {
namespace {

// A sphere of which this share was seen by a sensor in its centre, and the others from far away, each by the nearest of six sensors.
Orientation seen_from_within(const shapes::Surface& sphere, double share) {
  Options options;
  options.hints.sensors = {{0, 0, 0}};
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double far : {-100.0, 100.0}) {
      Vec3 sensor{0, 0, 0};
      sensor[a] = far;
      options.hints.sensors.push_back(sensor);
    }
  }
  for (std::size_t i = 0; i < sphere.points.size(); ++i) {
    const Vec3& n = sphere.normals[i];
    std::size_t most = 0;
    for (std::size_t a = 1; a < 3; ++a) most = std::abs(n[a]) > std::abs(n[most]) ? a : most;
    const auto outside = static_cast<std::uint32_t>(1 + 2 * most + (n[most] > 0 ? 1 : 0));
    options.hints.sensor_of_point.push_back(static_cast<double>(i % 100) < 100 * share ? 0 : outside);
  }
  return orient(sphere.points, options);
}

TEST(ApplyHints, AContradictionOfTheMajorityIsNotConsistent) {
  const shapes::Surface sphere = shapes::sphere(2000);
  for (const double share : {0.0, 0.55}) {
    const Orientation found = seen_from_within(sphere, share);
    EXPECT_EQ(shapes::share_correct(found.normals, sphere.normals), 1) << share;
    EXPECT_EQ(found.stats.hints.contradicted_share > 0.5, share > 0.5) << found.stats.hints.contradicted_share;
    EXPECT_EQ(found.stats.consistent, share < 0.5) << share;
    const auto says = [](const std::string& warning) { return warning.find("it contradicts the closed parts") != std::string::npos; };
    EXPECT_EQ(std::count_if(found.stats.warnings.begin(), found.stats.warnings.end(), says), share > 0.5 ? 1 : 0) << share;
  }
}

// A canopy over a floor, open all around: `--up` turns it, with a chance of two thirds and a warning; a sensor beneath it decides its side.
TEST(ApplyHints, UpWarnsOfWhatLiesOverOthers) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const double x = i + 0.3 * std::sin(7.1 * i + 3.3 * j), y = j + 0.3 * std::sin(5.7 * i - 8.9 * j);
      points.push_back({x, y, 0});
      if (i >= 10 && i < 30 && j >= 10 && j < 30) points.push_back({y, x, 12});
    }
  }
  const auto warns = [](const Orientation& found) {
    return std::any_of(found.stats.warnings.begin(), found.stats.warnings.end(),
                       [](const std::string& warning) { return warning.find("may have been seen from below") != std::string::npos; });
  };
  Options options;
  options.hints.up = Vec3{0, 0, 1};
  const Orientation up = orient(points, options);
  options.hints = Hints{.sensors = {{20, 20, 6}}};
  const Orientation seen = orient(points, options);
  EXPECT_TRUE(warns(up));
  EXPECT_FALSE(warns(seen));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool over = points[i][2] > 6;
    EXPECT_GT(up.normals[i][2], 0) << i;
    EXPECT_LE(up.confidence[i], over ? 2.0F / 3 : 1.0F) << i;
    EXPECT_GT(over ? -seen.normals[i][2] : seen.normals[i][2], 0) << i;
  }
}

}  // namespace
}  // namespace g3r
