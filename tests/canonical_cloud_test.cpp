// The cloud that all steps see: distinct points in a frame and an order of their own, whatever the caller's.
#include "cloud/canonical_cloud.h"

#include "base/vector.h"
#include "shapes.h"

#include <g3r/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace g3r {
namespace {

constexpr double kRoundingOfFrame = 1e-12;  // of a place that goes to the unit frame and back, over the extent

// A torus, far from the origin.
std::vector<Vec3> far_torus() { return shapes::torus(900, 60, 25, 3, {1e4, -2e4, 500}).points; }

TEST(CanonicalCloud, LongestSideOfItsFrameIsThatOfThePaper) {
  const std::vector<Vec3> points = far_torus();
  const CanonicalCloud cloud = canonical_cloud(points);
  vector::Box box;
  for (const Vec3& p : cloud.points()) box.extend(p);
  EXPECT_NEAR(box.longest_side(), kBoxSide, kRoundingOfFrame);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(box.low[a] + box.high[a], 0, kRoundingOfFrame);
  for (const Vec3& p : points) {
    const Vec3 back = cloud.frame.to_world(cloud.frame.to_unit(p));
    EXPECT_LT(vector::length(vector::subtract(back, p)), kRoundingOfFrame * 2e4);
  }
  EXPECT_DOUBLE_EQ(cloud.frame.length_to_world(cloud.frame.length_to_unit(3)), 3);
}

TEST(CanonicalCloud, IsTheSameForEveryOrderAndKnowsWhichPointIsWhich) {
  const std::vector<Vec3> points = far_torus();
  std::vector<Vec3> turned = points;
  std::rotate(turned.begin(), turned.begin() + 321, turned.end());
  std::reverse(turned.begin(), turned.begin() + 200);
  const CanonicalCloud one = canonical_cloud(points), other = canonical_cloud(turned);
  EXPECT_EQ(one.points(), other.points());
  for (std::size_t i = 0; i < turned.size(); ++i) EXPECT_EQ(other.points()[other.point_of[i]], other.frame.to_unit(turned[i]));
}

TEST(CanonicalCloud, MergesDuplicatesAndLeavesOutWhatIsNotFinite) {
  std::vector<Vec3> points = shapes::sphere(50).points;
  points.insert(points.end(), {points[7], points[7], points[20], {std::numeric_limits<double>::quiet_NaN(), 0, 0}, {0, HUGE_VAL, 0}});
  const CanonicalCloud cloud = canonical_cloud(points);
  EXPECT_EQ(cloud.size(), 50U);
  EXPECT_EQ(cloud.non_finite, 2U);
  EXPECT_EQ(cloud.multiplicity[cloud.point_of[7]], 3U);
  EXPECT_EQ(cloud.multiplicity[cloud.point_of[20]], 2U);
  EXPECT_EQ(cloud.multiplicity[cloud.point_of[8]], 1U);
  EXPECT_EQ(cloud.point_of[50], cloud.point_of[7]);
  EXPECT_EQ(cloud.point_of[53], kNoPoint);
  EXPECT_EQ(cloud.point_of[54], kNoPoint);
}

// What is left out changes nothing of the others, and is numbered after them, one number for each place.
TEST(CanonicalCloud, WhatIsLeftOutHasNoPartInTheFrame) {
  std::vector<Vec3> points = far_torus();
  const CanonicalCloud alone = canonical_cloud(points);
  points.insert(points.end(), {{9e9, 0, 0}, {0, 5e8, 0}, {9e9, 0, 0}});
  std::vector<std::uint8_t> left_out(points.size(), 0);
  std::fill(left_out.end() - 3, left_out.end(), std::uint8_t{1});
  std::vector<Vec3> others;
  const CanonicalCloud cloud = canonical_cloud(points, left_out, others);
  EXPECT_EQ(cloud.points(), alone.points());
  EXPECT_EQ(cloud.frame.centre, alone.frame.centre);
  ASSERT_EQ(others.size(), 2U);
  for (std::size_t i = points.size() - 3; i < points.size(); ++i) {
    ASSERT_GE(cloud.point_of[i], cloud.size());
    EXPECT_EQ(others[cloud.point_of[i] - cloud.size()], cloud.frame.to_unit(points[i]));
  }
  EXPECT_EQ(cloud.multiplicity[cloud.point_of.back()], 2U);
}

TEST(CanonicalCloud, RefusesWhatEnclosesNoVolume) {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {5, 10, 15}, {7, 14, 21}};
  EXPECT_THROW(static_cast<void>(canonical_cloud(line)), InvalidInput);
  const std::vector<Vec3> three{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}};
  EXPECT_THROW(static_cast<void>(canonical_cloud(three)), InvalidInput);
  const std::vector<Vec3> one(9, Vec3{1, 2, 3});
  EXPECT_THROW(static_cast<void>(canonical_cloud(one)), InvalidInput);
  EXPECT_THROW(static_cast<void>(canonical_cloud(std::vector<Vec3>{})), InvalidInput);
}

TEST(IsFlat, OfPointsInATiltedPlaneUntilOneLeavesIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) points.push_back({0.3 * i + 0.1 * j, 0.2 * j, 0.5 * i - 0.7 * j});
  }
  EXPECT_TRUE(is_flat(canonical_cloud(points)));
  points[40][2] += 1e-3;
  EXPECT_FALSE(is_flat(canonical_cloud(points)));
}

TEST(IsSmallInFrame, OfPointsThatFillLessThanHalfOfIt) {
  CanonicalCloud cloud = canonical_cloud(shapes::sphere(200).points);
  EXPECT_FALSE(is_small_in_frame(cloud));
  std::vector<Vec3> smaller = cloud.points();
  for (Vec3& p : smaller) p = vector::scale(p, 0.49);
  cloud.set = PointSet(std::move(smaller));
  EXPECT_TRUE(is_small_in_frame(cloud));
}

}  // namespace
}  // namespace g3r
