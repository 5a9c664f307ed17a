// Outliers and uneven density: what is left out, what is not, and that normals do not suffer.
#include "cloud/outliers.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/far_points.h"
#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "shapes.h"

#include <g3r/error.h>
#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r {
namespace {

constexpr std::size_t kPoints = 6000;

std::size_t flagged(const std::vector<Vec3>& points) { return find_outliers(canonical_cloud(points).set).indices.size(); }

// Samples of a torus of which the share falls by this ratio from one end to the other.
shapes::Surface uneven_torus(double ratio = 10) {
  const shapes::Surface dense = shapes::torus(4 * kPoints, 0.6, 0.25, 9);
  shapes::Surface uneven;
  shapes::Random random(4);
  for (std::size_t i = 0; i < dense.points.size(); ++i) {
    const double position = (dense.points[i][0] + 0.85) / 1.7;
    if (random.uniform() > std::pow(ratio, -position)) continue;
    uneven.points.push_back(dense.points[i]);
    uneven.normals.push_back(dense.normals[i]);
  }
  return uneven;
}

double share_right(const shapes::Surface& surface, const std::vector<Vec3>& normals) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vec3& a = surface.normals[i];
    const Vec3& b = normals[i];
    right += a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0.8 ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(surface.points.size());
}

TEST(Outliers, SamplesOfASurfaceAreNone) {
  EXPECT_EQ(flagged(shapes::torus(kPoints, 0.6, 0.25, 1).points), 0U);
  EXPECT_LE(flagged(uneven_torus().points), 6U);
}

// Stray points that are not found do not stand for the emptiness around them: the surface is as surely closed as without them.
TEST(Outliers, DoNotOpenAClosedSurface) {
  constexpr std::size_t kStray = 4000;
  const shapes::Surface sphere = shapes::sphere(8000, 1);
  std::vector<Vec3> points = sphere.points;
  shapes::Random random(7);
  for (std::size_t i = 0; i < kStray; ++i)
    points.push_back({random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3)});
  const Orientation o = orient(points);
  EXPECT_EQ(o.stats.open_share, 0);
  const auto sure = std::count_if(o.confidence.begin(), o.confidence.begin() + 8000, [](float c) { return c > 0.9F; });
  EXPECT_GT(static_cast<double>(sure), 0.8 * 8000);
}

TEST(Outliers, MostRandomPointsOfTheBoxAre) {
  shapes::Surface surface = shapes::torus(kPoints, 0.6, 0.25, 1);
  const std::size_t extra = kPoints / 20;
  shapes::Random random(3);
  std::vector<Vec3> points = surface.points;
  for (std::size_t i = 0; i < extra; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  EXPECT_GE(flagged(points), extra * 7 / 10);
  const Orientation o = orient(points);
  EXPECT_GE(share_right(surface, o.normals), 0.995);
  EXPECT_EQ(o.stats.outliers + o.stats.used, points.size());
  double confidence = 0;
  for (std::size_t i = kPoints; i < points.size(); ++i) confidence += static_cast<double>(o.confidence[i]) / static_cast<double>(extra);
  EXPECT_LT(confidence, 0.3);
}

// Points of a surface that are lost and stray points that are found, of a cloud that has the stray ones last.
std::pair<std::size_t, std::size_t> lost_and_found(const std::vector<Vec3>& points, std::size_t on) {
  const CanonicalCloud cloud = canonical_cloud(points);
  std::vector<char> taken(cloud.size(), 0);
  for (const std::uint32_t p : find_outliers(cloud.set).indices) taken[p] = 1;
  std::pair<std::size_t, std::size_t> counts{0, 0};
  for (std::size_t i = 0; i < points.size(); ++i)
    (i < on ? counts.first : counts.second) += static_cast<std::size_t>(taken[cloud.point_of[i]]);
  return counts;
}

// The 16 nearest of a sparse point of the surface fill space where strays lie among them; that more of those around are on one plane
// through it than chance puts there distinguishes the one from the other.
TEST(Outliers, StraysAmongThemMakeNoneOfSparsePoints) {
  std::vector<Vec3> points = uneven_torus(100).points;
  const std::size_t on = points.size(), extra = on / 5;
  shapes::Random random(3);
  for (std::size_t i = 0; i < extra; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  const auto [lost, found] = lost_and_found(points, on);
  EXPECT_LE(lost, on / 100);
  EXPECT_GE(found, extra * 8 / 10);
}

// They may be hardly sparser than the surface: what chance explains is measured against their number.
TEST(Outliers, MayBeDense) {
  std::vector<Vec3> points = shapes::sphere(kPoints, 1).points;
  shapes::Random random(3);
  constexpr std::size_t kStray = kPoints * 2 / 5;
  while (points.size() < kPoints + kStray) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (std::hypot(p[0], p[1], p[2]) < 1) points.push_back(p);
  }
  const auto [lost, found] = lost_and_found(points, kPoints);
  EXPECT_LE(lost, kPoints / 200);
  EXPECT_GE(found, kStray / 2);  // the others are too near the surface
}

// Noise of more than a spacing fills space too, and scatters points as far apart as outliers.
TEST(Outliers, NoiseMakesNone) {
  for (const double spacings : {0.5, 1.0, 1.5}) {
    shapes::Surface sphere = shapes::sphere(16000, 1);
    shapes::scatter(sphere, spacings * std::sqrt(4 * 3.14159265 / 16000));
    EXPECT_LE(flagged(sphere.points), 3U) << spacings;
    if (spacings < 1.5) continue;
    EXPECT_GE(find_outliers(canonical_cloud(sphere.points).set, {}, 0.0).indices.size(), 30U);  // told that there is no noise
  }
}

// Of a ball that is 20 times as dense at one end as at the other, under noise of one to four spacings, next to none are; in a box of
// outliers as many are found as without such noise.
TEST(Outliers, NoiseMakesNoneOfSparsePointsEither) {
  shapes::Random random(3);
  std::vector<Vec3> points;
  while (points.size() < kPoints) {
    const Vec3 n = random.direction();
    if (random.uniform() > std::exp(-1.5 * (1 + n[0]))) continue;
    Vec3 p = n;
    for (double& x : p) x += 0.07 * random.normal();
    points.push_back(p);
  }
  EXPECT_LT(flagged(points), kPoints / 50);
  for (std::size_t i = 0; i < kPoints / 10; ++i) {
    points.push_back({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)});
  }
  const std::vector<std::uint32_t> found = find_outliers(PointSet(points)).indices;
  EXPECT_GT(std::count_if(found.begin(), found.end(), [](std::uint32_t i) { return i >= kPoints; }), kPoints * 8 / 100);
}

TEST(Outliers, RemovedPointsAreNumberedAfterTheOthers) {
  CanonicalCloud cloud = canonical_cloud(shapes::torus(200, 0.6, 0.25, 1).points);
  const CanonicalCloud before = cloud;
  const std::vector<Vec3> removed = remove_points(cloud, {3, 77});
  ASSERT_EQ(cloud.size(), 198U);
  ASSERT_EQ(removed.size(), 2U);
  for (std::size_t i = 0; i < 200; ++i) {
    const std::uint32_t now = cloud.point_of[i];
    EXPECT_EQ(now < 198 ? cloud.points()[now] : removed[now - 198], before.points()[before.point_of[i]]);
  }
}

TEST(Outliers, WhatHasBeenFoundOutAboutTheOthersIsKept) {
  std::vector<Vec3> points = shapes::torus(kPoints, 0.6, 0.25, 1).points;
  shapes::Random random(3);
  for (std::size_t i = 0; i < kPoints / 20; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  CanonicalCloud cloud = canonical_cloud(points);
  const Outliers found = find_outliers(cloud.set);
  ASSERT_EQ(found.others.size(), cloud.size() - found.indices.size());
  ASSERT_LT(found.others.size(), cloud.size());
  static_cast<void>(remove_points(cloud, found.indices, found.others));
  EXPECT_EQ(&cloud.set.near(), &found.others.near());
  CanonicalCloud another = canonical_cloud(points);
  static_cast<void>(remove_points(another, {0}, found.others));  // which says nothing of these
  EXPECT_EQ(another.size(), points.size() - 1);
}

// A scanner that saw nothing says (0, 0, 0), which at UTM coordinates is a million sizes of the object away: what is left must be resolved
// as if it had never been there.
TEST(Outliers, FarStrayPointsChangeNothing) {
  shapes::Surface both = shapes::sphere(4000, 5, {5e5, 5.2e6, 100});
  const shapes::Surface cavity = shapes::sphere(4000, 4, {5e5, 5.2e6, 100});
  both.points.insert(both.points.end(), cavity.points.begin(), cavity.points.end());
  for (const Vec3& n : cavity.normals) both.normals.push_back({-n[0], -n[1], -n[2]});
  const Orientation without = orient(both.points);
  std::vector<Vec3> points = both.points;
  points.push_back({0, 0, 0});
  points.push_back({4.9e5, 5.2e6, 0});  // hidden by the first until that one is gone
  const Orientation with = orient(points);
  EXPECT_EQ(with.stats.outliers, 2U);
  EXPECT_NEAR(with.stats.spacing, without.stats.spacing, 1e-6 * without.stats.spacing);
  EXPECT_EQ(share_right(both, {with.normals.begin(), with.normals.begin() + 8000}), 1.0);
  EXPECT_LT(with.confidence[8000] + with.confidence[8001], 1e-6F);
  const Mesh mesh = reconstruct(points).mesh;
  for (const Vec3& v : mesh.vertices) ASSERT_LT(std::hypot(v[0] - 5e5, v[1] - 5.2e6, v[2] - 100), 5.2);
  const std::vector<Vec3> queries{{5e5, 5.2e6, 104.5}, {5e5, 5.2e6, 100}};  // in the wall and in the cavity
  const std::vector<double> winding = Field(points, with).value(queries), expected = Field(both.points, without).value(queries);
  EXPECT_GT(expected[0] - expected[1], 0.9);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(winding[i], expected[i], 1e-3);
}

// What is left out is numbered after the cloud, whose frame and points are those that it has without.
TEST(Outliers, TheFrameFollowsWhatIsLeft) {
  const std::vector<Vec3> torus = shapes::torus(200, 0.6, 0.25, 1).points;
  std::vector<Vec3> points = torus;
  points.insert(points.begin() + 50, {{100, 0, 0}, {-1e30, 0, 0}, {100, 0, 0}, {std::nan(""), 0, 0}, {-2e30, 0, 0}});
  std::vector<std::uint8_t> left_out(points.size(), 0);
  std::fill(left_out.begin() + 50, left_out.begin() + 55, std::uint8_t{1});
  std::vector<Vec3> others;
  const CanonicalCloud cloud = canonical_cloud(points, left_out, others), alone = canonical_cloud(torus);
  EXPECT_EQ(cloud.points(), alone.points());
  EXPECT_EQ(cloud.frame.to_world(others.back()), (Vec3{100, 0, 0}));
  ASSERT_EQ(others.size(), 3U);
  EXPECT_EQ(std::vector<std::uint32_t>(cloud.point_of.begin() + 50, cloud.point_of.begin() + 55),
            (std::vector<std::uint32_t>{202, 201, 202, kNoPoint, 200}));
  EXPECT_EQ(std::vector<std::uint32_t>(cloud.multiplicity.begin() + 200, cloud.multiplicity.end()), (std::vector<std::uint32_t>{1, 1, 2}));
  EXPECT_EQ(cloud.non_finite, 1U);
  for (const Vec3& place : {others[0], others[1]}) EXPECT_LT(place[0], -1e15);
  EXPECT_FALSE(is_small_in_frame(cloud));
}

// However far away and wherever in the list: the others have the bytes that they have alone.
TEST(FarPoints, ChangeNothing) {
  const std::vector<Vec3> sphere = shapes::sphere(2000).points;
  const Orientation alone = orient(sphere);
  for (const double distance : {1e8, 1e12, 1e13, 1e14, 1e15, 1e30, 1e38, 1e300}) {
    for (const std::size_t far : {std::size_t{1}, std::size_t{3}}) {
      std::vector<Vec3> points = sphere;
      for (std::size_t a = 0; a < far; ++a) {
        Vec3 place{0, 0.3 * distance, 0};
        place[a] = distance;
        points.insert(points.begin() + static_cast<std::ptrdiff_t>(a * 500), place);
      }
      const Orientation with = orient(points);
      EXPECT_EQ(with.stats.outliers, far) << distance;
      EXPECT_EQ(with.stats.merged_duplicates, 0U) << distance;
      std::vector<Vec3> normals;
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_TRUE(vector::is_finite(with.normals[i]));
        if (std::abs(points[i][1]) < 2 && std::abs(points[i][0]) < 2 && std::abs(points[i][2]) < 2) normals.push_back(with.normals[i]);
      }
      EXPECT_EQ(normals, alone.normals) << distance;
    }
  }
}

// Places that say that nothing was measured, of most points or a third of them; in no other cloud is a point too far.
TEST(FarPoints, AreFoundAmongMany) {
  shapes::Random random(3);
  std::vector<Vec3> points = shapes::sphere(2000).points;
  EXPECT_TRUE(far_points(points).empty());
  std::vector<Vec3> copies = points, spread = points, near = points;
  copies.insert(copies.end(), 5000, Vec3{1e30, 1e30, 1e30});
  near.insert(near.end(), 5000, Vec3{1e2, 5e3, 0});
  for (int i = 0; i < 900; ++i) spread.push_back({1e30 * random.uniform(-1, 1), 1e30 * random.uniform(-1, 1), 1e30});
  EXPECT_TRUE(far_points(near).empty());
  EXPECT_TRUE(far_points(std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1e9, 0, 0}, {0, 1e9, 0}}).empty());
  for (const std::vector<Vec3>& cloud : {copies, spread}) {
    const std::vector<std::uint8_t> marks = far_points(cloud);
    ASSERT_EQ(marks.size(), cloud.size());
    for (std::size_t i = 0; i < marks.size(); ++i) EXPECT_EQ(marks[i], i < 2000 ? 0 : 1);
    std::vector<Vec3> reversed(cloud.rbegin(), cloud.rend());
    EXPECT_EQ(far_points(reversed), std::vector<std::uint8_t>(marks.rbegin(), marks.rend()));
    EXPECT_EQ(orient(cloud).stats.outliers, cloud.size() == 7000 ? 1U : 900U);
  }
}

// A line is told as one, also where a stray is beside it.
TEST(FarPoints, DoNotMakeAPlaneOfALine) {
  std::vector<Vec3> line;
  for (int i = 0; i < 300; ++i) line.push_back({0.01 * i, 0, 0});
  EXPECT_THROW((void)orient(line), InvalidInput);
  line.push_back({1, 5, 2});
  EXPECT_THROW((void)orient(line), InvalidInput);
}

// Where points lie closer their areas are smaller, which is no reason for doubt.
TEST(Density, IsNoDoubt) {
  const std::size_t n = 6000;
  shapes::Surface surface = shapes::sphere(n);
  const shapes::Surface fine = shapes::sphere(12 * n);
  for (std::size_t i = 0; i < fine.points.size(); ++i) {
    if (fine.points[i][2] < 0.75) continue;
    surface.points.push_back(fine.points[i]);
    surface.normals.push_back(fine.normals[i]);
  }
  const Orientation o = orient(surface.points);
  EXPECT_TRUE(o.stats.consistent);
  EXPECT_LT(o.stats.confidence_below_half, 0.02);
}

// Kernels and areas follow the density under noise too: with those of the typical spacing the sparse end has wrong sides.
TEST(Density, MayFallUnderNoise) {
  shapes::Surface surface = uneven_torus(100);
  shapes::scatter(surface, 0.01);
  EXPECT_GE(share_right(surface, orient(surface.points).normals), 0.999);
  Options same_everywhere;
  same_everywhere.without = "local-widths";
  EXPECT_LT(share_right(surface, orient(surface.points, same_everywhere).normals), 0.995);
}

TEST(Density, MayFallTenfold) {
  const shapes::Surface surface = uneven_torus();
  EXPECT_GE(share_right(surface, orient(surface.points).normals), 0.999);
}

}  // namespace
}  // namespace g3r
