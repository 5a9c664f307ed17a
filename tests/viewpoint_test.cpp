// Truths about the place that a camera has seen a cloud from: found whatever the depths, and only where there is one.
#include "cloud/viewpoint.h"
#include "cloud/noise.h"

#include "shapes.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace g3r {
namespace {

using Depth = std::function<double(double, double)>;

// Pixels of a frame of 60 x 45, 53 degrees wide, with the depth along z at the slopes x/z and y/z; seen from `place`, along `turned` z.
std::vector<Vec3> frame(const Depth& depth, const Vec3& place = {0, 0, 0}, double turn = 0) {
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 45; ++j) {
      const double u = (i - 29.5) / 60, v = (j - 22) / 60.0, z = depth(u, v);
      const Vec3 p{u * z, v * z, z};
      points.push_back({place[0] + std::cos(turn) * p[0] + std::sin(turn) * p[2], place[1] + p[1],
                        place[2] - std::sin(turn) * p[0] + std::cos(turn) * p[2]});
    }
  }
  return points;
}

double waves(double u, double v) { return 2 + 0.2 * std::sin(9 * u) * std::cos(7 * v); }

Depth noisy(double sigma) {
  return [sigma, random = shapes::Random(5)](double u, double v) mutable { return waves(u, v) + sigma * random.gaussian(); };
}

// A table before a wall, depth in steps.
double stepped(double u, double v) {
  const double z = v < 0.1 ? 2 - 0.3 * u : std::min(2 - 0.3 * u, 0.3 / v);
  const double steps = 60;
  return steps / std::round(steps / z);
}

void expect_found(const std::vector<Vec3>& points, const Vec3& place, const Vec3& origin, const std::string& what) {
  const std::optional<Vec3> found = find_viewpoint(PointSet(points), origin);
  ASSERT_TRUE(found) << what;
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR((*found)[a], place[a], 1e-3) << what;
}

// The pixels are 1/30 apart: elsewhere a quarter of that in noise is enough.
TEST(Viewpoint, IsFoundWhateverTheNoiseOfTheDepths) {
  for (const double sigma : {0.0, 0.003, 0.25 / 30, 0.03, 0.2}) {
    expect_found(frame(noisy(sigma)), {0, 0, 0}, {0, 0, 0}, "noise " + std::to_string(sigma));
    const Vec3 place{3, -1, 0.5};
    if (sigma > 0.2 / 30) expect_found(frame(noisy(sigma), place, 0.7), place, {0, 0, 0}, "elsewhere, noise " + std::to_string(sigma));
  }
}

TEST(Viewpoint, IsFoundWhereDepthsAreRounded) { expect_found(frame(stepped), {0, 0, 0}, {0, 0, 0}, "steps"); }

TEST(Viewpoint, IsWhereTheCameraIsAndNotWhereTheOriginIs) {
  const Vec3 place{3, -1, 0.5};
  for (const Vec3& origin : {Vec3{0, 0, 0}, Vec3{3, -1, 0}, Vec3{3, -1, -40}, Vec3{0, 0, 100}}) {
    expect_found(frame(noisy(0.02), place), place, origin, "other origin");
  }
}

// No camera has seen these: samples of solids, rasters of terrain, whose rows are in parallel planes, and directions on a grid from inside.
TEST(Viewpoint, IsNotFoundWhereThereIsNone) {
  shapes::Random random(3);
  const auto none = [](const std::vector<Vec3>& points, const Vec3& origin, const std::string& what) {
    EXPECT_FALSE(find_viewpoint(PointSet(points), origin)) << what;
  };
  none(shapes::sphere(3000).points, {0, 0, -5}, "sphere");
  none(shapes::plates(3, 1, 0.2, 0.3, 0.05).points, {0, 0, 5}, "plates");
  std::vector<Vec3> raster;
  std::vector<Vec3> around;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      raster.push_back({0.1 * i, 0.1 * j, 0.5 * waves(0.02 * i, 0.03 * j) + 0.02 * random.gaussian()});
      const double a = 0.1 * i, b = 0.04 * (j - 30), r = 2 + 0.1 * random.gaussian();
      around.push_back({r * std::cos(a) * std::cos(b), r * std::sin(a) * std::cos(b), r * std::sin(b)});
    }
  }
  for (const Vec3& origin : {Vec3{0, 0, 0}, Vec3{3, 3, 9}, Vec3{3, 3, 1e6}, Vec3{-20, 3, 1}}) none(raster, origin, "raster");
  none(around, {0, 0, 0}, "all around");
}

TEST(Viewpoint, PlanesOfRowsAreAlongTheSight) {
  const PointSet set(frame(noisy(0.02)), Views{{{0, 0, 0}}, {}});
  for (std::size_t i = 0; i < set.size(); i += 100) {
    const Vec3& p = set.points()[i];
    const double size = std::hypot(p[1], p[2]);
    const Vec3 of_row{0, p[2] / size, -p[1] / size};
    EXPECT_TRUE(is_along_sight(set, i, of_row));
    EXPECT_FALSE(is_along_sight(set, i, {0, 0, 1}));
    EXPECT_FALSE(is_along_sight(PointSet(set.points()), i, of_row));
  }
}

// Rows of noisy pixels are exact planes, but no facets: the scatter is seen, and is no less than half the noise and no more than thrice.
TEST(Viewpoint, NoiseAlongTheSightIsSeen) {
  for (const double sigma : {0.01, 0.02, 0.03}) {
    const double scatter = largest_scatter(PointSet(frame(noisy(sigma)), Views{{{0, 0, 0}}, {}}));
    EXPECT_GT(scatter, sigma / 2) << sigma;
    EXPECT_LT(scatter, sigma * 3) << sigma;
  }
}

// The report says where the camera stood, in the coordinates of the caller, and all points face it without a hint, under noise too.
TEST(Viewpoint, EveryPointFacesTheCamera) {
  for (const double sigma : {0.0, 0.02, 0.08}) {
    std::vector<Vec3> points = frame(noisy(sigma), {0, 0, 0});
    for (Vec3& p : points) p = {10 * p[0], 10 * p[1], 10 * p[2]};  // other units
    const Orientation seen = orient(points);
    ASSERT_TRUE(seen.stats.hints.viewpoint) << sigma;
    EXPECT_LT(std::hypot((*seen.stats.hints.viewpoint)[0], (*seen.stats.hints.viewpoint)[1], (*seen.stats.hints.viewpoint)[2]), 1e-9);
    EXPECT_EQ(seen.stats.open_share, 1) << sigma;
    EXPECT_EQ(seen.stats.undecided_share, 0) << sigma;
    EXPECT_TRUE(seen.stats.consistent) << sigma;
    std::size_t away = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& n = seen.normals[i];
      away += n[0] * points[i][0] + n[1] * points[i][1] + n[2] * points[i][2] > 0 ? 1 : 0;
    }
    EXPECT_LT(away, points.size() / 100) << sigma;
    Options options;
    options.hints.flip = true;
    const Orientation flipped = orient(points, options);
    for (std::size_t i = 0; i < points.size(); i += 50) EXPECT_EQ(flipped.normals[i][2], -seen.normals[i][2]);
    options.hints.flip = false;
    options.without = "viewpoint";
    EXPECT_FALSE(orient(points, options).stats.hints.viewpoint);
  }
}

// What the camera sees at a grazing angle faces it as well, which is no choice, and the middle of the cloud is no better place.
TEST(Viewpoint, LeavesNoChoiceOfAFloor) {
  const std::vector<Vec3> points = frame([](double u, double v) {  // a ball at (0, 0, 2) on a floor before a wall
    const double ray = 1 + u * u + v * v, inside = 4 - ray * (4 - 0.09);
    return inside > 0 ? (2 - std::sqrt(inside)) / ray : v > 0.06 ? 0.3 / v : 5;
  });
  const Orientation seen = orient(points);
  ASSERT_TRUE(seen.stats.hints.viewpoint);
  EXPECT_EQ(seen.stats.undecided_share, 0);
  EXPECT_TRUE(seen.stats.consistent);
  for (const std::string& warning : seen.stats.warnings) EXPECT_EQ(warning.find("is a choice"), std::string::npos) << warning;
  Options options;
  options.hints.seen_from_inside = true;
  EXPECT_EQ(orient(points, options).normals, seen.normals);
}

// A box of 8 x 6 x 4 with a pillar, as a scanner at this place in it sees them, on a grid of angles, with noise along the lines of sight.
std::vector<Vec3> panorama(double sigma, const Vec3& place = {0, 0, 0}) {
  shapes::Random random(11);
  const Vec3 low{-3, -2, -1.5}, high{5, 4, 2.5};
  std::vector<Vec3> points;
  for (int i = 0; i < 180; ++i) {
    for (int j = -30; j <= 30; ++j) {
      const double a = 2 * std::numbers::pi * i / 180, e = 0.03 * j;
      const Vec3 d{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
      double range = HUGE_VAL;
      for (std::size_t k = 0; k < 3; ++k) {
        if (d[k] != 0) range = std::min(range, ((d[k] > 0 ? high[k] : low[k]) - place[k]) / d[k]);
      }
      const double to_pillar = (2 - place[0]) / d[0];  // a square of 0.6 whose front is at x = 2
      if (to_pillar > 0 && std::abs(place[1] + to_pillar * d[1]) < 0.3) range = std::min(range, to_pillar);
      range += sigma * random.gaussian();
      points.push_back({place[0] + range * d[0], place[1] + range * d[1], place[2] + range * d[2]});
    }
  }
  return points;
}

// What one scanner has seen all around it faces the scanner, under noise as well, if the caller says where it stood.
TEST(Viewpoint, APanoramaFacesTheScannerThatIsNamed) {
  for (const double sigma : {0.0, 0.02, 0.06}) {
    const std::vector<Vec3> points = panorama(sigma);
    EXPECT_FALSE(find_viewpoint(PointSet(points), {0, 0, 0})) << sigma;  // it may be a star-shaped body
    EXPECT_TRUE(may_be_seen_from(points, {0, 0, 0})) << sigma;
    Options options;
    options.hints.sensors = {{0, 0, 0}};
    const Orientation seen = orient(points, options);
    EXPECT_TRUE(seen.stats.consistent) << sigma;
    EXPECT_GE(seen.stats.noise, sigma / 2) << sigma;
    EXPECT_LE(seen.stats.noise, 3 * sigma) << sigma;
    std::size_t away = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& n = seen.normals[i];
      away += n[0] * points[i][0] + n[1] * points[i][1] + n[2] * points[i][2] > 0 ? 1 : 0;
    }
    EXPECT_LT(away, points.size() / 200) << sigma;
    EXPECT_GT(seen.stats.confidence_mean, 0.8) << sigma;
    EXPECT_GT(seen.stats.hints.settled_share, 0.4) << sigma;  // a room without a hint faces the walls
    EXPECT_EQ(seen.stats.hints.given, std::vector<std::string>{"sensor"}) << sigma;
  }
}

// Of two scans every point faces its own scanner, although the noise makes closed walls of what both have seen.
TEST(Viewpoint, EveryPointOfSeveralScansFacesItsScanner) {
  for (const double sigma : {0.01, 0.04}) {
    Options options;
    options.hints.sensors = {{0, 0, 0}, {1, -1.5, 0.4}};
    std::vector<Vec3> points;
    for (std::uint32_t scan = 0; scan < 2; ++scan) {
      for (const Vec3& p : panorama(sigma, options.hints.sensors[scan])) {
        points.push_back(p);
        options.hints.sensor_of_point.push_back(scan);
      }
    }
    const Orientation seen = orient(points, options);
    EXPECT_TRUE(seen.stats.consistent) << sigma;
    EXPECT_FALSE(seen.stats.hints.viewpoint) << sigma;  // there are two
    std::size_t away = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& n = seen.normals[i];
      const Vec3& scanner = options.hints.sensors[options.hints.sensor_of_point[i]];
      away += n[0] * (points[i][0] - scanner[0]) + n[1] * (points[i][1] - scanner[1]) + n[2] * (points[i][2] - scanner[2]) > 0 ? 1 : 0;
    }
    EXPECT_LT(away, points.size() / 200) << sigma;
    EXPECT_GT(seen.stats.confidence_mean, 0.8) << sigma;
  }
}

// A scanner of which no point is left, as outside --box, is no reason to forget the others.
TEST(Viewpoint, AScannerWithoutPointsSaysNothing) {
  const std::vector<Vec3> points = panorama(0.01);
  const std::vector<std::uint32_t> first(points.size(), 0);
  EXPECT_TRUE(may_be_seen(points, {{{0, 0, 0}, {30, 0, 0}}, first}));
  EXPECT_FALSE(may_be_seen(points, {{{0, 0, -40}, {30, 0, 0}}, first}));
}

// A scanner beside a solid cannot have seen what lies behind its front.
TEST(Viewpoint, ASolidIsNotSeenFromOnePlace) {
  const std::vector<Vec3> sphere = shapes::sphere(4000).points;
  for (const Vec3& place : {Vec3{0, 0, -1.5}, Vec3{3, 1, 2}, Vec3{0, 0, 1e4}}) EXPECT_FALSE(may_be_seen_from(sphere, place));
  EXPECT_FALSE(may_be_seen_from(shapes::plates(2, 2, 0.2, 0.5, 0.05).points, {0.3, 0.1, 5}));
}

}  // namespace
}  // namespace g3r
