// Parts of a cloud that chance makes of outliers, and those that are surface.
#include "mesh/point_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "field_shapes.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

constexpr std::size_t kBall = 2000, kBead = 60;

std::vector<Vec3> random_points(std::size_t count, const Vec3& low, double side, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(0, side);
  std::vector<Vec3> out(count);
  for (Vec3& p : out) {
    for (std::size_t a = 0; a < 3; ++a) p[a] = low[a] + uniform(rng);
  }
  return out;
}

// A ball, and beside it a small one of the same density.
std::vector<Vec3> ball_and_bead() {
  std::vector<Vec3> points = sphere_sample(kBall, 1, 1).points;
  for (const Vec3& p : sphere_sample(kBead, std::sqrt(double(kBead) / kBall), 2).points) points.push_back({p[0] + 3, p[1], p[2]});
  return points;
}

std::size_t kept(const std::vector<std::uint8_t>& held) { return static_cast<std::size_t>(std::count(held.begin(), held.end(), 1)); }

TEST(PointParts, AllStayWithoutStrays) {
  std::vector<Vec3> points = ball_and_bead();
  points.push_back({9, 9, 9});
  const PointSet set(points);
  EXPECT_EQ(kept(mesh::points_of_parts(set, {})), points.size());
}

// The bead has more points than strays are beside it.
TEST(PointParts, SmallPartsAmongOutliersStay) {
  const PointSet set(ball_and_bead());
  EXPECT_EQ(kept(mesh::points_of_parts(set, random_points(500, {-10, -10, -10}, 20, 3))), set.size());
}

// Points in the sky that seem to hold each other, among many that do not.
TEST(PointParts, PartsOfACloudThatFillsSpaceGo) {
  std::vector<Vec3> points = ball_and_bead();
  const std::size_t surface = points.size();
  for (const Vec3& p : random_points(40, {10, 10, 10}, 10, 4)) points.push_back(p);
  const PointSet set(points);
  const std::vector<std::uint8_t> held = mesh::points_of_parts(set, random_points(400, {10, 10, 10}, 10, 5));
  EXPECT_EQ(kept(held), surface);
  for (std::size_t i = 0; i < surface; ++i) EXPECT_EQ(held[i], 1) << i;
}

// Fuzzy clouds beside a ball, denser than it, go, also where no stray is seen. Noise fills space as well, but in all parts alike.
TEST(PointParts, DensePartsThatFillSpaceGo) {
  std::mt19937_64 rng(6);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Vec3> points = ball_and_bead();
  const std::size_t surface = points.size();
  for (const double x : {6.0, 9.0}) {
    for (int k = 0; k < 400; ++k) points.push_back({x + 0.2 * normal(rng), 0.2 * normal(rng), 0.2 * normal(rng)});
  }
  const std::vector<std::uint8_t> held = mesh::points_of_parts(PointSet(points), {});
  for (std::size_t i = 0; i < surface; ++i) EXPECT_EQ(held[i], 1) << i;
  EXPECT_LT(kept(held), surface + 80);  // the thin rims of the fuzzy clouds are parts of few points
  std::vector<Vec3> noisy = sphere_sample(kBall, 1, 1).points;
  for (const Vec3& p : sphere_sample(300, std::sqrt(300.0 / kBall), 2).points) noisy.push_back({p[0] + 3, p[1], p[2]});
  for (Vec3& p : noisy) p = {p[0] + 0.06 * normal(rng), p[1] + 0.06 * normal(rng), p[2] + 0.06 * normal(rng)};
  EXPECT_EQ(kept(mesh::points_of_parts(PointSet(noisy), {})), noisy.size());
}

// Fewer points than chance makes of so many strays are no part, wherever those are.
TEST(PointParts, FewerThanChanceMakesGo) {
  std::vector<Vec3> points = ball_and_bead();
  const std::size_t surface = points.size();
  for (int k = 0; k < 5; ++k) points.push_back({20 + 0.1 * k, 0, 0});
  const PointSet set(points);
  EXPECT_EQ(kept(mesh::points_of_parts(set, random_points(500, {-10, -10, -10}, 20, 3))), surface);
}

}  // namespace
