// Flat facets: found whole, distinguished from curved surfaces, and each on the side that its points decide together.
#include "orient/facets.h"

#include "cloud/canonical_cloud.h"
#include "cloud/neighbours.h"
#include "cloud/spacing.h"

#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr double kSpacing = 0.02;

Facets facets_of(const Surface& s, const std::vector<Vec3>& normals) {
  return find_facets(PointSet(s.points), std::vector<std::uint8_t>(s.points.size(), 1), normals, 0);
}

// Turns the normals of every fifth point round.
std::vector<Vec3> partly_turned(std::vector<Vec3> normals) {
  for (std::size_t i = 0; i < normals.size(); i += 5) {
    for (double& c : normals[i]) c = -c;
  }
  return normals;
}

TEST(Facets, AreTheFacesOfABox) {
  const Surface box = shapes::plates(1, 1, 20, 5, kSpacing);
  for (const std::vector<Vec3>& normals : {box.normals, partly_turned(box.normals)}) {
    const Facets facets = facets_of(box, normals);
    std::set<std::uint32_t> found(facets.of.begin(), facets.of.end());
    found.erase(Facets::kNone);
    EXPECT_EQ(facets.count, 6U);
    EXPECT_EQ(found.size(), 6U);
    for (std::size_t i = 1; i < box.points.size(); ++i) {
      if (facets.of[i] == Facets::kNone || facets.of[i - 1] == Facets::kNone) continue;
      EXPECT_EQ(facets.of[i] == facets.of[i - 1], box.normals[i] == box.normals[i - 1]);
    }
  }
}

TEST(Facets, OfAThinWallAreItsSides) {
  const Surface wall = shapes::plates(1, 1, 0.1, 5, kSpacing);
  const Facets facets = facets_of(wall, wall.normals);
  ASSERT_GE(facets.count, 2U);
  for (std::size_t i = 0; i < wall.points.size(); ++i) {
    for (const std::size_t j : {std::size_t{0}, wall.points.size() / 2}) {
      if (facets.of[i] != facets.of[j] || facets.of[j] == Facets::kNone) continue;
      EXPECT_EQ(wall.normals[i], wall.normals[j]);
    }
  }
}

// However smooth a surface, a facet never goes round it.
TEST(Facets, StayFlatOnSmoothSurfaces) {
  const Surface sphere = shapes::sphere(20000);
  EXPECT_EQ(facets_of(sphere, sphere.normals).count, 0U);
  // A part of a sphere so large that all near points count as in one plane, while normals 8 apart differ by 4.6 degrees.
  constexpr double kRadius = 100;
  Surface dense;
  shapes::Random random(3);
  for (int i = 0; i < 25600; ++i) {
    const Vec3 p{random.uniform(-4, 4), random.uniform(-4, 4), 0};
    const double height = std::sqrt(kRadius * kRadius - p[0] * p[0] - p[1] * p[1]);
    dense.points.push_back({p[0], p[1], height - kRadius});
    dense.normals.push_back({p[0] / kRadius, p[1] / kRadius, height / kRadius});
  }
  const Facets caps = facets_of(dense, dense.normals);
  ASSERT_GT(caps.count, 0U);
  std::vector<Vec3> first(caps.count, Vec3{0, 0, 0});
  for (std::size_t i = 0; i < dense.points.size(); ++i) {
    if (caps.of[i] == Facets::kNone) continue;
    Vec3& n = first[caps.of[i]];
    if (n == Vec3{0, 0, 0}) n = dense.normals[i];
    EXPECT_GT(n[0] * dense.normals[i][0] + n[1] * dense.normals[i][1] + n[2] * dense.normals[i][2], 0.998);
  }
}

TEST(Facets, HaveAWantedPoint) {
  const Surface box = shapes::plates(1, 1, 20, 5, kSpacing);
  const PointSet set(box.points);
  const std::vector<std::uint8_t> proven(box.points.size(), 1);
  std::vector<std::uint8_t> wanted(box.points.size(), 0);
  EXPECT_EQ(find_facets(set, proven, box.normals, 0, wanted).count, 0);
  wanted[0] = 1;
  const Facets one = find_facets(set, proven, box.normals, 0, wanted);
  EXPECT_EQ(one.count, 1);
  EXPECT_EQ(one.of[0], 0);
}

TEST(Facets, CountPointsOfTheMinoritySign) {
  const Surface box = shapes::plates(1, 1, 20, 5, kSpacing);
  const std::vector<Vec3> turned = partly_turned(box.normals);
  EXPECT_EQ(minority_share(facets_of(box, box.normals), box.normals), 0);
  EXPECT_NEAR(minority_share(facets_of(box, turned), turned), 0.2, 0.005);
}

// Every fifth point is turned: of those that are asked for none, or nearly all, as a few at the edges are on no facet.
TEST(Facets, CountWantedPointsAlone) {
  const Surface box = shapes::plates(1, 1, 20, 5, kSpacing);
  const std::vector<Vec3> turned = partly_turned(box.normals);
  const Facets facets = facets_of(box, turned);
  std::vector<std::uint8_t> wanted(turned.size(), 0);
  for (std::size_t i = 1; i < wanted.size(); i += 5) wanted[i] = 1;
  EXPECT_EQ(minority_share(facets, turned, wanted), 0);
  wanted.assign(wanted.size(), 0);
  for (std::size_t i = 0; i < wanted.size(); i += 5) wanted[i] = 1;
  EXPECT_GT(minority_share(facets, turned, wanted), 0.95);
}

// Walls a tenth of a spacing thick: single points cannot tell their side (51 % right without facets), facets can.
TEST(Facets, OfWallsThinnerThanTheSpacingTellTheirSides) {
  if (kSanitized) GTEST_SKIP() << "a whole solve, whose result is what counts";
  const Surface walls = shapes::plates(4, 1, 0.1, 6, 0.04);
  EXPECT_GE(shapes::share_correct(orient(walls.points).normals, walls.normals), 0.97);
}

// Points that scatter about their facets, as a scanner's do: their planes are theirs to within that, and no wall is another's.
TEST(Facets, OfPointsThatScatterAreWhole) {
  Surface wall = shapes::plates(1, 1, 0.5, 5, kSpacing);
  shapes::scatter(wall, 0.01 * kSpacing);
  const PointSet set(wall.points);
  const std::vector<std::uint8_t> proven(wall.points.size(), 1);
  const Facets facets = find_facets(set, proven, wall.normals, 0.01 * kSpacing);
  std::vector<std::size_t> held(facets.count, 0);
  std::vector<Vec3> first(facets.count, Vec3{0, 0, 0});
  for (std::size_t i = 0; i < wall.points.size(); ++i) {
    if (facets.of[i] == Facets::kNone) continue;
    if (held[facets.of[i]]++ == 0) first[facets.of[i]] = wall.normals[i];
    EXPECT_EQ(wall.normals[i], first[facets.of[i]]);
  }
  std::sort(held.begin(), held.end());
  ASSERT_GE(held.size(), 2U);
  for (std::size_t side = 1; side <= 2; ++side) EXPECT_GE(static_cast<double>(held[held.size() - side]), 0.98 / (kSpacing * kSpacing));
}

// Walls of 0.3 h whose points scatter by a hundredth of that and more: 60 to 85 % by single points.
TEST(Facets, OfThinWallsTellTheirSidesUnderALittleNoise) {
  if (kSanitized) GTEST_SKIP() << "a whole solve, whose result is what counts";
  for (const double sigma : {0.0, 0.002, 0.005, 0.01, 0.02}) {
    Surface walls = shapes::plates(4, 1, 0.3, 6, 0.04);
    shapes::scatter(walls, sigma * 0.04);
    EXPECT_GE(shapes::share_correct(orient(walls.points).normals, walls.normals), 0.97) << sigma;
  }
}

// Walls half a spacing thick, one apart: 52 % right in steps too few and too wide, 97 % if points on no facet keep their normals.
TEST(Facets, CloseTogetherTellTheirSidesAndThoseOfPointsBesideThem) {
  if (kSanitized) GTEST_SKIP() << "a whole solve, whose result is what counts";
  const Surface walls = shapes::plates(4, 0.5, 0.5, 1, kSpacing);
  EXPECT_GE(shapes::share_correct(orient(walls.points).normals, walls.normals), 0.98);
}

// The projector keeps area vectors that are one multiple of A_i n_i on a facet, so a solution on the right sides stays there.
TEST(Facets, OnTheRightSideStayThere) {
  const Surface box = shapes::plates(2, 1, 5, 5, 0.04);
  const CanonicalCloud cloud = canonical_cloud(box.points);
  std::vector<Vec3> truth(cloud.size());
  for (std::size_t i = 0; i < box.points.size(); ++i) truth[cloud.point_of[i]] = box.normals[i];
  const std::vector<double>& spacing = cloud.set.smoothed_spacing();
  const Facets facets = find_facets(cloud.set, std::vector<std::uint8_t>(cloud.size(), 1), truth, 0);
  std::vector<Vec3> eta = truth;
  for (std::size_t i = 0; i < eta.size(); ++i) {
    for (double& c : eta[i]) c *= spacing[i] * spacing[i];
  }
  std::vector<Vec3> normals = truth;
  const Monitor monitor;
  Stages stages(monitor);
  const Settings settings = choose_settings({}, cloud, typical_spacing(spacing), 0, 0);
  choose_facet_sides(cloud.set, settings, facets, eta, normals, stages);
  EXPECT_EQ(normals, truth);
  for (std::size_t i = 0; i < eta.size(); ++i) {
    if (facets.of[i] == Facets::kNone) continue;
    const double along = eta[i][0] * truth[i][0] + eta[i][1] * truth[i][1] + eta[i][2] * truth[i][2];
    EXPECT_NEAR(along, std::hypot(eta[i][0], eta[i][1], eta[i][2]), 1e-12);
  }
}

}  // namespace
}  // namespace g3r
