// Truths about normals from lines of sight: right under noise that hides them in space, certain where that is known.
#include "orient/sight_normals.h"

#include "base/vector.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r {
namespace {

// Pixels of a frame of 80 x 60, or finer, whose depth along z is that of a place, plus noise.
std::vector<Vec3> frame(const std::function<double(double, double)>& depth, double sigma, const Vec3& place, int width = 80) {
  shapes::Random random(3);
  std::vector<Vec3> points;
  const int height = width * 3 / 4;
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < height; ++j) {
      const double u = (i + 0.5) / width - 0.5, v = (j + 0.5) / width - 0.375;
      const double z = depth(u, v) + sigma * random.gaussian();
      points.push_back({place[0] + u * z, place[1] + v * z, place[2] + z});
    }
  }
  return points;
}

// z = 2 + x / 2 seen from 0.
double slope(double u, double) { return 2 / (1 - u / 2); }

TEST(SightNormals, AreThoseOfAPlaneSeenExactly) {
  const Vec3 place{1, 2, 3};
  const SightNormals found = normals_by_sight(PointSet(frame(slope, 0, place), Views{{place}, {}}), {0.01});
  const Vec3 normal = vector::normalised({0.5, 0, -1});
  for (const Vec3& n : found.normals) EXPECT_NEAR(vector::dot(n, normal), 1, 1e-9);
  for (const float c : found.certified) EXPECT_GT(c, 0.999F);
}

// Noise of one and a half pixels leaves no surface in space; along the sights it turns normals by 15 degrees.
TEST(SightNormals, HaveNoBiasUnderNoise) {
  const double sigma = 1.5 * 2 / 80;
  const SightNormals found = normals_by_sight(PointSet(frame(slope, sigma, {0, 0, 0}), Views{{{0, 0, 0}}, {}}), {sigma});
  const Vec3 normal = vector::normalised({0.5, 0, -1});
  Vec3 sum{0, 0, 0};
  double worst = 1;
  for (const Vec3& n : found.normals) {
    sum = vector::add(sum, n);
    worst = std::min(worst, vector::dot(n, normal));
  }
  EXPECT_GT(vector::dot(vector::normalised(sum), normal), 0.995);
  EXPECT_GT(worst, 0);
}

// A wall behind the edge of a nearer one: each keeps its own direction.
TEST(SightNormals, DoNotBendAtEdges) {
  const double sigma = 0.01;
  const auto step = [](double u, double) { return u < 0.1 ? 1.5 : 3.0; };
  const SightNormals found = normals_by_sight(PointSet(frame(step, sigma, {0, 0, 0}), Views{{{0, 0, 0}}, {}}), {sigma});
  std::size_t bent = 0;
  for (const Vec3& n : found.normals) bent += n[2] > -0.8 ? 1 : 0;
  EXPECT_LT(bent, found.normals.size() / 50);
}

// The bumps of a wall leave more the wider the fits are, and count as no noise; noise is found to a fifth.
TEST(SightNoise, IsWhatDoesNotGrow) {
  const auto bumps = [](double u, double v) { return 3 + 0.1 * std::sin(25 * u) * std::sin(25 * v); };
  const auto noise_of = [](const std::vector<Vec3>& points) { return find_sight_noise(PointSet(points, Views{{{0, 0, 0}}, {}})); };
  EXPECT_EQ(noise_of(frame(bumps, 0, {0, 0, 0})).deviation, 0);
  for (const double sigma : {0.02, 0.05}) {
    const SightNoise found = noise_of(frame(bumps, sigma, {0, 0, 0}));
    EXPECT_NEAR(found.deviation, sigma, sigma / 5);
    EXPECT_EQ(found.together, 1);
  }
}

// Depths in steps that are six pixels wide: each step is a plane across the view, and only several of them show the slope.
TEST(SightNoise, OfStepsIsOfManyPointsTogether) {
  const double step = 0.1;
  const auto stairs = [step](double u, double v) { return step * std::round(slope(u, v) / step); };
  const PointSet set(frame(stairs, 0, {0, 0, 0}, 160), Views{{{0, 0, 0}}, {}});
  const SightNoise found = find_sight_noise(set);
  EXPECT_GT(found.together, 1);
  EXPECT_NEAR(found.deviation, step / std::sqrt(12), step / 10);
  const Vec3 normal = vector::normalised({0.5, 0, -1});
  const auto angle = [&](const SightNoise& noise) {
    double sum = 0;
    for (const Vec3& n : normals_by_sight(set, noise).normals) sum += std::acos(std::min(1.0, vector::dot(n, normal)));
    return sum / static_cast<double>(set.size());
  };
  EXPECT_LT(angle(found), 0.3 * angle({found.deviation}));
}

// Two scanners on either side of a wall see a side each.
TEST(SightNormals, EveryPointFacesItsOwnSensor) {
  const std::vector<Vec3> front = frame([](double, double) { return 2.0; }, 0.01, {0, 0, 0});
  std::vector<Vec3> points = front;
  Views views{{{0, 0, 0}, {0, 0, 4}}, std::vector<std::uint32_t>(front.size(), 0)};
  for (const Vec3& p : front) {
    points.push_back({p[0], p[1], 4 - p[2]});
    views.of_point.push_back(1);
  }
  const SightNormals found = normals_by_sight(PointSet(points, views), {0.01});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT(found.normals[i][2] * (i < front.size() ? 1 : -1), 0);
}

}  // namespace
}  // namespace g3r
