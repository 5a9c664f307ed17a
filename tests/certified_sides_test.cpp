// Sides that the field shows to be right: those of closed surfaces, not turned ones, nor those of bowls.
#include "orient/certified_sides.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

std::vector<float> certified(const shapes::Surface& s, const std::vector<Vec3>& normals, double noise = 0) {
  return certified_sides(PointSet(s.points), noise, sum_plan(1e-2, s.points.size()), normals);
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v);
  return sum / static_cast<double>(values.size());
}

// The certificate is that of the sides that are given: a point that is turned has none, and a bowl, which is not at rest, nowhere.
TEST(CertifiedSides, AreThoseOfTheGivenNormals) {
  const shapes::Surface s = shapes::sphere(3000);
  for (const float c : certified(s, s.normals)) EXPECT_GT(c, 0.9F);
  std::vector<Vec3> turned = s.normals;
  for (std::size_t i = 0; i < turned.size(); i += 100) turned[i] = vector::scale(turned[i], -1);
  const std::vector<float> of_turned = certified(s, turned);
  for (std::size_t i = 0; i < turned.size(); i += 100) EXPECT_EQ(of_turned[i], 0) << i;
  shapes::Surface bowl;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (s.points[i][2] < 0.3) continue;
    bowl.points.push_back(s.points[i]);
    bowl.normals.push_back(s.normals[i]);
  }
  for (const float c : certified(bowl, bowl.normals)) EXPECT_EQ(c, 0);
}

TEST(CertifiedSides, OfFewPointsNoneIs) {
  const shapes::Surface few = shapes::sphere(29), more = shapes::sphere(100);
  EXPECT_EQ(certified(few, few.normals), std::vector<float>(29, 0));
  EXPECT_GT(mean(certified(more, more.normals)), 0.5);
}

// Under noise, normals that face either way at one place show nothing, whatever the field is.
TEST(CertifiedSides, UnderNoiseMixedSidesCountForLess) {
  shapes::Surface s = shapes::sphere(4000);
  const double sigma = 0.5 * std::sqrt(s.areas[0]);
  shapes::scatter(s, sigma);
  std::vector<Vec3> mixed = s.normals;
  for (std::size_t i = 0; i < mixed.size(); i += 4) mixed[i] = vector::scale(mixed[i], -1);
  const double right = mean(certified(s, s.normals, sigma));
  EXPECT_GT(right, 0.7);
  EXPECT_LT(mean(certified(s, mixed, sigma)), 0.5 * right);
}

// The length of the mean of two directions that are at an angle is the cosine of half of it.
TEST(Concentration, IsTheMeanResultantLength) {
  const shapes::Surface s = shapes::sphere(2000);
  const Sites sites = place_sites(PointSet(s.points), 4 * std::sqrt(s.areas[0]));
  const std::vector<Vec3> same(2000, Vec3{0, 0, 1});
  for (const double c : concentration(sites, same)) EXPECT_NEAR(c, 1, 1e-12);
  std::vector<Vec3> two = same, opposite = same;
  for (std::size_t i = 0; i < two.size(); i += 2) {
    two[i] = {std::sqrt(0.75), 0, 0.5};  // 60 degrees
    opposite[i] = {0, 0, -1};
  }
  for (const double c : concentration(sites, two)) EXPECT_NEAR(c, std::sqrt(0.75), 0.02);
  for (const double c : concentration(sites, opposite)) EXPECT_LT(c, 0.2);
}

}  // namespace
}  // namespace g3r
