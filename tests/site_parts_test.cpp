// The parts of a cloud: what hangs together, how much of space each encloses, and how fine its sites are.
#include "orient/site_parts.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

SiteParts parts_of(const PointSet& set) { return {set, 0, sum_plan(1e-2, set.size()), nullptr}; }

// Of a sphere, the part above a height.
shapes::Surface cap(double least_z) {
  const shapes::Surface whole = shapes::sphere(6000);
  shapes::Surface s;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    if (whole.points[i][2] < least_z) continue;
    s.points.push_back(whole.points[i]);
    s.normals.push_back(whole.normals[i]);
  }
  return s;
}

TEST(SiteParts, AreWhatHangsTogether) {
  const std::size_t n = 500;
  std::vector<Vec3> points;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const Vec3& p : shapes::sphere(n, 0.3, {x, 0, 0}).points) points.push_back(p);
  }
  const PointSet set(points);
  const SiteParts parts = parts_of(set);
  ASSERT_EQ(parts.count(), 3U);
  std::vector<double> value(3 * n);
  for (std::uint32_t i = 0; i < 3 * n; ++i) {
    EXPECT_EQ(parts.of_point(i), i / n);
    value[i] = i % n < n / 2 ? -1 : static_cast<double>(i / n);
  }
  for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(parts.members(p).size(), n);
  EXPECT_EQ(parts.means(value), (std::vector<double>{0, 1, 2}));  // negative values are left out
  EXPECT_EQ(parts.means(std::vector<double>(3 * n, -1)), (std::vector<double>{0, 0, 0}));
}

// By Gauss, w is 1/2 on a closed surface, and -1/2 inside out. On a bowl it is the solid angle over 4 pi, 1 - sqrt(1/2) in its middle.
TEST(SiteParts, EncloseAllNothingOrSome) {
  const shapes::Surface sphere = cap(-1), half = cap(0), plate = cap(0.88);
  const auto enclosure = [](const shapes::Surface& s, double sign) {
    std::vector<Vec3> normals;
    for (const Vec3& n : s.normals) normals.push_back(vector::scale(n, sign));
    const PointSet set(s.points);
    const SiteParts parts = parts_of(set);
    return parts.enclosure(parts.members(0), normals);
  };
  EXPECT_NEAR(enclosure(sphere, 1), 1, 0.1);
  EXPECT_NEAR(enclosure(sphere, -1), -1, 0.1);
  EXPECT_NEAR(enclosure(half, 1), 0.62, 0.08);
  EXPECT_LT(std::abs(enclosure(plate, 1)), 0.25);
}

TEST(SiteParts, TestWhatTheyAreGiven) {
  const shapes::Surface s = shapes::sphere(2000);
  const PointSet set(s.points);
  const SiteParts parts = parts_of(set);
  const Certificate right = parts.test(s.normals);
  EXPECT_LT(parts.means(right.unrest)[0], 0.06);
  EXPECT_LT(parts.means(right.jump_defect)[0], 0.2);
  EXPECT_EQ(parts.jump_defects({s.normals}).all.front(), right.jump_defect);
}

// Many points are thinned for their number, which says nothing of how far the field of a closed surface is at rest.
TEST(SiteParts, KnowWhetherTheyAreThinnedForNoise) {
  const PointSet few(shapes::sphere(2000).points);
  const PointSet many(shapes::sphere(kMostSites + 20000).points);
  const SiteParts of_few = parts_of(few), of_many = parts_of(many);
  EXPECT_EQ(of_few.sites().size(), few.size());
  EXPECT_LT(of_many.sites().size(), many.size());
  EXPECT_FALSE(of_few.thinned_for_noise());
  EXPECT_FALSE(of_many.thinned_for_noise());
  EXPECT_TRUE(SiteParts(few, few.spacing(), sum_plan(1e-2, few.size()), nullptr).thinned_for_noise());
}

// Sites are two standard deviations of the noise apart, and no more than 200,000, which many points are farther apart for.
TEST(SiteDistance, FollowsTheNoiseAndTheNumberOfPoints) {
  EXPECT_EQ(site_distance(1000, 0.01, 0), 0);
  EXPECT_EQ(site_distance(kMostSites, 0.01, 0), 0);
  EXPECT_DOUBLE_EQ(site_distance(1000, 0.01, 0.02), 0.04);
  EXPECT_DOUBLE_EQ(site_distance(16 * kMostSites, 0.01, 0), kFirstDistance * 4 * 0.01);
  EXPECT_DOUBLE_EQ(site_distance(16 * kMostSites, 0.01, 0.02), kFirstDistance * 4 * 0.01);
}

}  // namespace
}  // namespace g3r
