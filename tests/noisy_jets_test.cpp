// Normals of noisy points from quadratic fits: better where the surface is smooth, left alone at thin walls.
#include "orient/noisy_jets.h"

#include "base/median.h"
#include "base/vector.h"
#include "cpu/parallel.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr std::size_t kCount = 8000;
constexpr double kTurned = 0.12;  // radians in each coordinate of the normals before: what the winding gradient leaves

double sphere_spacing() { return 0.9 * std::sqrt(4 * std::numbers::pi / static_cast<double>(kCount)); }

std::vector<Vec3> fitted(const Surface& s, std::vector<Vec3> normals, double noise) {
  fit_noisy_jets(PointSet(s.points), noise, {}, normals);
  return normals;
}

// Random points of two squares of side 2 that face up at z = 0 and down at z = -thickness, one spacing apart.
Surface wall(double thickness, double spacing) {
  shapes::Random random(11);
  Surface s;
  const auto count = static_cast<std::size_t>(8 / (spacing * spacing));
  for (std::size_t i = 0; i < count; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    s.points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), i % 2 == 0 ? 0 : -thickness});
    s.normals.push_back({0, 0, side});
  }
  return s;
}

// The error is a squared angle: a quarter of it is half the angle.
TEST(NoisyJets, HalveTheAnglesOnASphere) {
  const double h = sphere_spacing();
  for (const double sigma : {0.25, 0.5, 1.0}) {
    Surface s = shapes::sphere(kCount);
    shapes::scatter(s, sigma * h);
    const std::vector<Vec3> before = shapes::disturbed(s.normals, kTurned);
    EXPECT_LT(shapes::angle_error(fitted(s, before, sigma * h), s.normals), shapes::angle_error(before, s.normals) / 4) << sigma;
  }
}

// Of any direction, and where single normals are 0.1 radians off: half of them end within a few thousandths.
TEST(NoisyJets, FindTheNormalOfAPlane) {
  const double h = 0.05;
  const Vec3 normal{0.48, 0.64, 0.6}, u{0.8, -0.6, 0}, v{0.36, 0.48, -0.8};
  Surface s = wall(0, h);
  for (Vec3& p : s.points) p = vector::add(vector::scale(u, p[0]), vector::scale(v, p[1]));
  shapes::scatter(s, 0.5 * h);
  std::vector<Vec3> before(s.points.size(), normal);
  for (std::size_t i = 0; i < before.size(); i += 50) before[i] = vector::normalised(vector::add(normal, vector::scale(u, 0.1)));
  const std::vector<Vec3> after = fitted(s, before, 0.5 * h);
  std::vector<double> off, off_where_wrong;  // 1 - cosine
  for (std::size_t i = 0; i < after.size(); ++i) (i % 50 == 0 ? off_where_wrong : off).push_back(1 - vector::dot(after[i], normal));
  EXPECT_LT(median(off), 5e-6);
  EXPECT_LT(median(off_where_wrong), 5e-6);
}

TEST(NoisyJets, KeepTheSidesOfAWall) {
  const double h = 0.05;
  const double sigma = 0.4 * h;
  Surface s = wall(12 * sigma, h);
  shapes::scatter(s, sigma);
  const std::vector<Vec3> before = shapes::disturbed(s.normals, kTurned);
  const std::vector<Vec3> after = fitted(s, before, sigma);
  EXPECT_LT(shapes::angle_error(after, s.normals), shapes::angle_error(before, s.normals) / 2);
  EXPECT_EQ(shapes::share_correct(after, s.normals), 1);
}

TEST(NoisyJets, LeaveAWallAsThinAsTheNoiseAlone) {
  const double h = 0.05;
  const double sigma = 0.4 * h;
  Surface s = wall(4 * sigma, h);
  shapes::scatter(s, sigma);
  const std::vector<Vec3> before = shapes::disturbed(s.normals, kTurned);
  const std::vector<Vec3> after = fitted(s, before, sigma);
  std::size_t same = 0;
  for (std::size_t i = 0; i < after.size(); ++i) same += after[i] == before[i] ? 1 : 0;
  EXPECT_GT(same, before.size() * 9 / 10);
}

// With the noise of the other torus the error is 0.00039.
TEST(NoisyJets, FollowTheNoiseOfAPlaceThatHasLess) {
  const std::size_t count = 8192;  // of each torus, a multiple of the points that share a noise
  const double h = 0.9 * std::sqrt(4 * std::numbers::pi * std::numbers::pi * 0.6 * 0.1 / static_cast<double>(count));
  Surface smooth = shapes::torus(count, 0.6, 0.1, 6, {-1, 0, 0});
  shapes::scatter(smooth, 0.1 * h);
  Surface noisy = shapes::torus(count, 0.6, 0.1, 7, {1, 0, 0});
  shapes::scatter(noisy, 0.8 * h);
  const Surface both = shapes::join(smooth, noisy);
  std::vector<Vec3> normals = fitted(both, shapes::disturbed(both.normals, 0.05), 0.8 * h);
  normals.resize(count);
  EXPECT_LT(shapes::angle_error(normals, smooth.normals), 0.00025);
}

TEST(NoisyJets, LeaveFewPointsAsTheyAre) {
  const std::vector<Vec3> few{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<Vec3> normals(3, Vec3{0, 0, 1});
  fit_noisy_jets(PointSet(few), 0.1, {}, normals);
  EXPECT_EQ(normals, std::vector<Vec3>(3, Vec3{0, 0, 1}));
}

TEST(NoisyJets, AreTheSameWithAnyNumberOfThreads) {
  const double h = sphere_spacing();
  Surface s = shapes::sphere(kCount);
  shapes::scatter(s, 0.5 * h);
  const std::vector<Vec3> before = shapes::disturbed(s.normals, kTurned);
  const auto with = [&](int threads) { return parallel::with_threads(threads, [&] { return fitted(s, before, 0.5 * h); }); };
  EXPECT_EQ(with(1), with(0));
}

TEST(NoisyJets, StopWhenAsked) {
  const Surface s = shapes::sphere(kCount);
  std::vector<Vec3> normals = s.normals;
  const std::atomic<bool> cancel{true};
  EXPECT_THROW(fit_noisy_jets(PointSet(s.points), 0.01, {}, normals, &cancel), Cancelled);
}

// Of a whole run: without the fits it is 0.0022.
TEST(NoisyJets, MakeTheNormalsOfANoisyTorusBetter) {
  Surface s = shapes::torus(20000, 0.6, 0.25, 6);
  shapes::scatter(s, 0.01);
  const Orientation o = orient(s.points);
  EXPECT_EQ(shapes::share_correct(o.normals, s.normals), 1);
  EXPECT_LT(shapes::angle_error(o.normals, s.normals), 0.0013);
}

}  // namespace
}  // namespace g3r
