// Whether walls that were found explain noisy points, and what orient() makes of walls that noise hides.
#include "orient/walls.h"

#include "base/vector.h"
#include "cloud/point_set.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr double kApart = 0.02;  // of the points of the walls

void add_noise(Surface& s, double sigma, shapes::Random& random) {
  for (Vec3& p : s.points) {
    for (double& x : p) x += sigma * random.normal();
  }
}

// Random points of a square of side 1.8, half of them on a wall that faces down, half on one that faces up, `gap` above it.
Surface two_walls(double gap, double sigma) {
  shapes::Random random(5);
  Surface s;
  const auto count = static_cast<std::size_t>(2 * 1.8 * 1.8 / (kApart * kApart));
  for (std::size_t i = 0; i < count; ++i) {
    const bool up = i % 2 == 0;
    s.points.push_back({random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), up ? gap : 0});
    s.normals.push_back({0, 0, up ? 1.0 : -1.0});
  }
  add_noise(s, sigma, random);
  return s;
}

// Random points of a ball that is hollow: a wall of `thick` spacings, under noise of `sigma` spacings.
Surface hollow_ball(std::size_t count, double thick, double sigma, std::uint64_t seed) {
  shapes::Random random(seed);
  const double outer_area = 4 * std::numbers::pi;
  double inner = 0.9;
  double apart = 0;
  for (int i = 0; i < 30; ++i) {
    apart = std::sqrt(outer_area * (1 + inner * inner) / static_cast<double>(count));
    inner = 1 - thick * apart;
  }
  const auto outside = static_cast<std::size_t>(static_cast<double>(count) / (1 + inner * inner));
  Surface s;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = random.uniform(-1, 1), angle = random.uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    const Vec3 n{r * std::cos(angle), r * std::sin(angle), z};
    const bool is_outside = i < outside;
    s.points.push_back(is_outside ? n : Vec3{inner * n[0], inner * n[1], inner * n[2]});
    s.normals.push_back(is_outside ? n : Vec3{-n[0], -n[1], -n[2]});
  }
  add_noise(s, sigma * apart, random);
  return s;
}

std::vector<Vec3> all_up(const Surface& s) { return {s.points.size(), {0, 0, 1}}; }

// A point between two walls of 3 sigma that are taken for one is as far from it as the noise and half of that distance carry it.
TEST(Walls, MisfitTellsTwoWallsTakenForOne) {
  const double sigma = 0.8 * kApart;
  const Surface s = two_walls(3 * sigma, sigma);
  const PointSet set(s.points);
  const PlacesOnWalls merged = fit_places(set, all_up(s), sigma, kApart);
  const PlacesOnWalls separate = fit_places(set, s.normals, sigma, kApart);
  EXPECT_NEAR(misfit(separate), 1, 0.15);
  EXPECT_GT(misfit(merged), 1.3);
  EXPECT_NEAR(turned_share(merged, separate), 0.5, 0.05);
  EXPECT_EQ(turned_share(separate, separate), 0);
}

// Whatever the noise is taken for: heights about two walls are not normally distributed about the one between them.
TEST(Walls, TwoWallsTakenForOneAreHiddenAndWallsThatAreFoundAreNot) {
  const double sigma = 0.5 * kApart;
  for (const double taken_for : {0.5, 0.7, 1.0}) {
    for (const double gap : {0.0, 1.8, 2.5, 4.0}) {
      const Surface s = two_walls(gap * sigma, sigma);
      const PointSet set(s.points);
      EXPECT_EQ(excess_about_walls(set, all_up(s), taken_for * kApart, kApart).is_two_walls(), gap > 0) << gap << ' ' << taken_for;
      EXPECT_FALSE(excess_about_walls(set, s.normals, taken_for * kApart, kApart).may_be_two_walls()) << gap << ' ' << taken_for;
    }
  }
}

// Rounding spreads heights evenly, as two walls do that are close together; but it is known.
TEST(Walls, RoundedHeightsAreOneWall) {
  Surface s = two_walls(0, 0);
  shapes::Random random(7);
  for (Vec3& p : s.points) p[2] += 0.2 * p[0] + 0.1 * p[1] + 0.1 * kApart * random.normal();
  for (Vec3& p : s.points) p[2] = std::round(p[2] / kApart) * kApart;
  const PointSet set(s.points);
  EXPECT_FALSE(excess_about_walls(set, all_up(s), 0.3 * kApart, kApart).may_be_two_walls());
}

TEST(Walls, OfFewPointsNothingIsSaid) {
  const PointSet set({{0, 0, 0}, {1, 0, 0.1}, {0, 1, 0}, {0, 0, 1}});
  const std::vector<Vec3> up(4, {0, 0, 1});
  EXPECT_EQ(excess_about_walls(set, up, 0.1, 1).mean, 0);
  EXPECT_EQ(misfit(fit_places(set, up, 0.1, 1)), 1);
}

// Walls of 3.6 sigma, 5.4 sigma apart, under noise of 0.55 spacings: kernels that hide it take them for one. Nothing says that sides are
// right, but most are.
TEST(Walls, NarrowerKernelsAreTakenWhereWallsMerge) {
  Surface s = shapes::plates(6, 0.65, 2, 3, 0.02);
  shapes::scatter(s, 0.55 * 0.02);
  Options without;
  without.without = "noise-choice";
  const double wide = shapes::share_correct(orient(s.points, without).normals, s.normals);
  const Orientation found = orient(s.points);
  EXPECT_GT(shapes::share_correct(found.normals, s.normals), std::max(0.85, wide + 0.05)) << wide;
  EXPECT_NEAR(found.stats.noise, 0.55 * 0.02, 0.1 * 0.02);  // the noise, not what kernels hide
}

// More noise than there is makes one surface of a thin wall, of which every side is sure.
TEST(Walls, AreNotTakenForMoreNoise) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Surface s = hollow_ball(2000, 1.4, 0.3, seed);
    EXPECT_GT(shapes::share_correct(orient(s.points).normals, s.normals), 0.9) << seed;
  }
}

// Walls 2 to 3 sigma thick, one spacing: hardly any method finds them. Nothing may be sure that the half is right which it is.
TEST(Walls, ThatNoiseHidesAreNotSure) {
  for (const double sigma : {0.3, 0.4, 0.5}) {
    const Surface s = hollow_ball(3000, 1, sigma, 2);
    const Orientation found = orient(s.points);
    std::size_t wrong_and_sure = 0;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      const bool is_wrong = vector::dot(found.normals[i], s.normals[i]) < 0;
      wrong_and_sure += is_wrong && found.confidence[i] > 0.9F ? 1 : 0;
    }
    EXPECT_LE(wrong_and_sure, 9U) << sigma;  // 0.3 %
    EXPECT_FALSE(found.stats.consistent) << sigma;
    EXPECT_GT(shapes::share_correct(found.normals, s.normals), 0.6) << sigma;
  }
}

}  // namespace
}  // namespace g3r
