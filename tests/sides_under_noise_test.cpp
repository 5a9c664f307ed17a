// Sides of noisy points: most are right, and those that are wrong have a low confidence.
#include <g3r/g3r.h>

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

// The wall of a cavity, a dozen standard deviations from all else, under noise of more than a spacing.
TEST(Noise, CavitiesKeepTheirSides) {
  for (const double sigma : {1.2, 1.4, 1.6}) {
    Surface shells = shapes::join(shapes::sphere(16000, 0.8), shapes::sphere(4000, 0.4), true);
    shapes::scatter(shells, sigma * 0.0225);  // of the spacing
    const Orientation o = orient(shells.points);
    EXPECT_GT(shapes::share_correct(o.normals, shells.normals), 0.999) << sigma;
    EXPECT_LT(o.stats.confidence_below_half, 0.05) << sigma;
  }
}

// Noisy points on the wrong side must have lower confidence: area under the ROC curve.
TEST(Confidence, RanksWrongSidesOnNoisyData) {
  shapes::Random random(4);
  Surface s = shapes::join(shapes::torus(6000, 0.6, 0.12, 6), shapes::ellipsoid(4000, 0.4, 0.4, 0.05, {0, 0, 0}));
  for (Vec3& p : s.points) {
    for (double& c : p) c += 0.01 * random.gaussian();  // 0.5 % of the diagonal
  }
  const Orientation o = orient(s.points);
  std::vector<std::pair<float, bool>> ranked;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const double cosine = o.normals[i][0] * s.normals[i][0] + o.normals[i][1] * s.normals[i][1] + o.normals[i][2] * s.normals[i][2];
    ranked.emplace_back(o.confidence[i], cosine > 0);
  }
  std::sort(ranked.begin(), ranked.end());
  double wrong = 0;
  double right = 0;
  double area = 0;
  for (const auto& [confidence, good] : ranked) {
    if (good) {
      area += wrong;
      ++right;
    } else {
      ++wrong;
    }
  }
  ASSERT_GT(wrong, 50);
  EXPECT_GT(area / (wrong * right), 0.85) << wrong << " of " << wrong + right << " wrong";
}

// Two walls closer together than the noise: half of the sides are wrong, and nothing shows which.
TEST(Confidence, PromisesNothingWhereNoiseHidesTheWalls) {
  const double spacing = 0.02;
  Surface plate = shapes::join(shapes::plates(1, 1, 1, 1, spacing), shapes::sphere(9000, 0.4, {0, 0, 1}));
  shapes::scatter(plate, 1.2 * spacing);
  const Orientation o = orient(plate.points);
  std::size_t sure_and_wrong = 0;
  for (std::size_t i = 0; i < plate.points.size(); ++i) {
    const Vec3& n = plate.normals[i];
    const double cosine = o.normals[i][0] * n[0] + o.normals[i][1] * n[1] + o.normals[i][2] * n[2];
    if (cosine < 0 && o.confidence[i] > 0.9F) ++sure_and_wrong;
  }
  EXPECT_LE(sure_and_wrong, plate.points.size() * 3 / 1000);
  EXPECT_LT(shapes::share_correct(o.normals, plate.normals), 0.95);  // there is something to be unsure of
  EXPECT_FALSE(o.stats.consistent);
}

// Right sides are promised, not only ranked: what no wall is near to is sure under noise too. Vectors of single points follow the noise:
// from them a third of these points is unsure.
TEST(Confidence, IsSureOfASphereUnderNoise) {
  shapes::Random random(6);
  Surface s = shapes::sphere(8000, 1);
  const double spacing = std::sqrt(4 * 3.14159265 / 8000);
  for (Vec3& p : s.points) {
    for (double& c : p) c += 0.7 * spacing * random.gaussian();
  }
  const Orientation o = orient(s.points);
  EXPECT_TRUE(o.stats.consistent);
  const auto unsure = std::count_if(o.confidence.begin(), o.confidence.end(), [](float c) { return c < 0.5F; });
  EXPECT_LT(static_cast<double>(unsure), 0.1 * 8000);
  const auto sure = std::count_if(o.confidence.begin(), o.confidence.end(), [](float c) { return c > 0.9F; });
  EXPECT_GT(static_cast<double>(sure), 0.5 * 8000);
  EXPECT_GT(shapes::share_correct(o.normals, s.normals), 0.99);
}

}  // namespace
}  // namespace g3r
