// Surfaces that pass through each other are found, at several angles and spacings; creases, walls on others, thin and parallel walls and
// sharp tips are not taken for them.
#include "mesh/crossings.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "base/vector.h"
#include "field_shapes.h"
#include "sanitized.h"

namespace g3r {
namespace {

using mesh::Crossings;
using mesh::find_crossings;
using testing::cube_sample;
using testing::OrientedSample;
using testing::sphere_sample;

constexpr double kDegree = M_PI / 180;

Crossings found_in(const OrientedSample& sample) { return find_crossings(PointSet(sample.points), sample.normals); }

OrientedSample both(OrientedSample a, const OrientedSample& b) {
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  return a;
}

OrientedSample moved(OrientedSample sample, const Vec3& by) {
  for (Vec3& p : sample.points) p = vector::add(p, by);
  return sample;
}

Vec3 turned(const Vec3& p, double angle) {
  return {p[0], std::cos(angle) * p[1] - std::sin(angle) * p[2], std::sin(angle) * p[1] + std::cos(angle) * p[2]};
}

// About the x axis.
OrientedSample turned(OrientedSample sample, double angle) {
  for (Vec3& p : sample.points) p = turned(p, angle);
  for (Vec3& n : sample.normals) n = turned(n, angle);
  return sample;
}

// z = 0, x in [-1, 1], y in [low, high].
OrientedSample patch(std::size_t n, double low, double high, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> x(-1, 1), y(low, high);
  OrientedSample out;
  for (std::size_t i = 0; i < n; ++i) {
    const double u = x(rng);
    out.points.push_back({u, y(rng), 0});
    out.normals.push_back({0, 0, 1});
  }
  return out;
}

// The sides of a slab of a thickness, 2 x 2 wide.
OrientedSample slab(std::size_t n, double thickness, std::uint64_t seed) {
  OrientedSample below = patch(n / 2, -1, 1, seed);
  for (Vec3& normal : below.normals) normal = {0, 0, -1};
  return both(moved(patch(n / 2, -1, 1, seed + 1), {0, 0, thickness}), below);
}

// The points of a sample that are outside of the cube [-half, half]^3, or inside.
OrientedSample cut(const OrientedSample& sample, double half, bool outside) {
  OrientedSample out;
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    const Vec3& p = sample.points[i];
    if ((std::max({std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])}) > half) != outside) continue;
    out.points.push_back(p);
    out.normals.push_back(sample.normals[i]);
  }
  return out;
}

// A cone of height 2 and radius r, without its base.
OrientedSample cone(std::size_t n, double radius) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  OrientedSample out;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = std::sqrt(uniform(rng)), turn = 2 * M_PI * uniform(rng), length = std::hypot(2, radius);
    out.points.push_back({radius * t * std::cos(turn), radius * t * std::sin(turn), 2 - 2 * t});
    out.normals.push_back({2 * std::cos(turn) / length, 2 * std::sin(turn) / length, radius / length});
  }
  return out;
}

TEST(Crossings, PatchesAreSeenFrom45Degrees) {
  for (const std::size_t n : {2000U, 8000U}) {
    for (const double angle : {45.0, 60.0, 90.0}) {
      const Crossings found = found_in(both(patch(n, -1, 1, 1), turned(patch(n, -1, 1, 2), angle * kDegree)));
      EXPECT_TRUE(found.is_clear) << n << " points, " << angle << " degrees: " << found.share;
      EXPECT_NEAR(found.angle, angle, 1e-6);
    }
  }
}

TEST(Crossings, SolidsThatOverlapAreSeen) {
  for (const std::size_t n : {2000U, 8000U}) {
    EXPECT_TRUE(found_in(both(sphere_sample(n, 1, 1), moved(sphere_sample(n, 1, 2), {1.2, 0, 0}))).is_clear) << n;
    EXPECT_TRUE(found_in(both(cube_sample(n, 1, 1), turned(cube_sample(n, 1, 2), 45 * kDegree))).is_clear) << n;
    EXPECT_TRUE(found_in(both(cube_sample(n, 1, 1), moved(turned(slab(n, 0.5, 2), 90 * kDegree), {0.4, 0.1, 0.3}))).is_clear) << n;
  }
}

TEST(Crossings, NoiseOfAThirdOfTheSpacingHidesNone) {
  OrientedSample sample = both(patch(4000, -1, 1, 1), turned(patch(4000, -1, 1, 2), 70 * kDegree));
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal(0, 0.32 * std::sqrt(4.0 / 4000));
  for (Vec3& p : sample.points) p = vector::add(p, {normal(rng), normal(rng), normal(rng)});
  EXPECT_TRUE(found_in(sample).is_clear);
}

TEST(Crossings, CreasesAndWallsOnOthersAreNone) {
  for (const std::size_t n : {2000U, 8000U}) {
    EXPECT_EQ(found_in(cube_sample(n, 1, 1)).share, 0) << n;
    for (const double angle : {45.0, 90.0, 135.0}) {
      const OrientedSample half = turned(patch(n / 2, 0, 1, 2), angle * kDegree);
      EXPECT_EQ(found_in(both(patch(n / 2, 0, 1, 1), half)).share, 0) << n << " points, crease of " << angle;
      EXPECT_FALSE(found_in(both(patch(n, -1, 1, 1), half)).is_clear) << n << " points, wall at " << angle;
    }
    // A smaller cube on a larger one, and a cube cut out of another.
    const OrientedSample large = cube_sample(n, 1, 1), small = moved(cube_sample(n / 2, 0.5, 2), {0, 0, 1});
    EXPECT_FALSE(found_in(both(moved(cut(moved(large, {0, 0, -1}), 0.5, true), {0, 0, 1}), cut(small, 1, true))).is_clear) << n;
  }
}

// Bumps and dents in turn, each as wide as half a wave, with slopes up to an angle: detail of a scan.
OrientedSample bumps(std::size_t n, double wave, double steepest) {
  OrientedSample out = patch(n, -1, 1, 1);
  const double k = 2 * M_PI / wave, height = std::tan(steepest) / k;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3& p = out.points[i];
    const double sx = std::sin(k * p[0]), cx = std::cos(k * p[0]), sy = std::sin(k * p[1]), cy = std::cos(k * p[1]);
    p[2] = height * sx * sy;
    out.normals[i] = vector::normalised({-height * k * cx * sy, -height * k * sx * cy, 1});
  }
  return out;
}

TEST(Crossings, BumpsAreNone) {
  const std::size_t n = 8000;
  const double spacing = std::sqrt(4.0 / static_cast<double>(n));
  for (const double wave : {4.0, 6.0, 8.0, 10.0}) {
    for (const double steepest : {20.0, 25.0, 30.0}) {
      const Crossings found = found_in(bumps(n, wave * spacing, steepest * kDegree));
      EXPECT_FALSE(found.is_clear) << wave << " spacings, " << steepest << " degrees: " << found.share;
    }
  }
}

TEST(Crossings, ThinAndParallelWallsAndTipsAreNone) {
  const std::size_t n = 4000;
  const double spacing = std::sqrt(8.0 / static_cast<double>(n));  // of both sides of a slab
  for (const double thickness : {0.3, 0.6, 1.0, 1.5, 2.5}) {
    EXPECT_EQ(found_in(slab(n, thickness * spacing, 1)).share, 0) << thickness;
    // Two thin walls that cross, as one solid: a plus without what is within.
    const auto outside_of_other = [&](OrientedSample wall) {
      OrientedSample out;
      for (std::size_t i = 0; i < wall.points.size(); ++i) {
        if (std::fabs(wall.points[i][1]) < thickness * spacing / 2) continue;
        out.points.push_back(wall.points[i]);
        out.normals.push_back(wall.normals[i]);
      }
      return out;
    };
    const Vec3 down{0, 0, -thickness * spacing / 2};
    const OrientedSample one = outside_of_other(moved(slab(n, thickness * spacing, 1), down));
    const OrientedSample other = turned(outside_of_other(moved(slab(n, thickness * spacing, 3), down)), 90 * kDegree);
    EXPECT_FALSE(found_in(both(one, other)).is_clear) << thickness;
  }
  EXPECT_FALSE(found_in(cone(n, 0.3)).is_clear);
  EXPECT_FALSE(found_in(sphere_sample(100, 1, 1)).is_clear);
  EXPECT_EQ(found_in({}).share, 0);
}

TEST(Crossings, TheRunWarns) {
  const std::size_t n = kSanitized ? 400 : 1000;
  const auto warns = [](const OrientedSample& sample) {
    const std::vector<std::string> warnings = orient(sample.points).stats.warnings;
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& w) { return w.rfind("two surfaces cross: ", 0) == 0; });
  };
  EXPECT_TRUE(warns(both(cube_sample(n, 1, 1), turned(cube_sample(n, 1, 2), 45 * kDegree))));
  EXPECT_FALSE(warns(cube_sample(2 * n, 1, 1)));
}

}  // namespace
}  // namespace g3r
