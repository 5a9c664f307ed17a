// Sides that neighbours agree on: mirrored normals of arcs, one side of a surface without an inside, at every scale.
#include "orient/agreement.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace g3r {
namespace {

// Random points of a wavy surface over [-1, 1]^2, and its upward normals.
shapes::Surface waves(int count) {
  shapes::Random random(5);
  shapes::Surface s;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    s.points.push_back({x, y, 0.1 * std::sin(5 * x) * std::cos(4 * y)});
    s.normals.push_back(vector::normalised({-0.5 * std::cos(5 * x) * std::cos(4 * y), 0.4 * std::sin(5 * x) * std::sin(4 * y), 1}));
  }
  return s;
}

double share_up(const std::vector<Vec3>& normals) {
  std::size_t up = 0;
  for (const Vec3& n : normals) up += n[2] > 0 ? 1 : 0;
  return static_cast<double>(up) / static_cast<double>(normals.size());
}

// Mean cosine of the angle between the axes of normals.
double up_to_sign(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(vector::dot(normals[i], truth[i]));
  return sum / static_cast<double>(truth.size());
}

// The six ends of the axes as sites of the unit sphere.
Sites ends_of_axes(double distance) {
  Sites sites;
  sites.distance = distance;
  sites.axis = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  sites.set = PointSet(sites.axis);
  sites.flatness.assign(6, 0);
  return sites;
}

// Two radial normals of a sphere are mirror images of each other: n_i . n_j - 2 (n_i . e)(n_j . e) = 1, but for the errors of the planes.
TEST(AdjacentSites, AgreeOnASphereWhereTheirAxesFaceTheSameWay) {
  const Sites sites = place_sites(PointSet(shapes::sphere(2000).points), 0);
  const std::vector<SignEdge> edges = adjacent_sites(sites);
  EXPECT_GE(edges.size(), 10 * sites.size() / 2);
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const SignEdge& edge : edges) {
    EXPECT_TRUE(pairs.insert(std::minmax(edge.a, edge.b)).second);  // every pair once
    const double same = vector::dot(sites.axis[edge.a], sites.points()[edge.a]) * vector::dot(sites.axis[edge.b], sites.points()[edge.b]);
    EXPECT_GT(same * edge.weight, 0);
    EXPECT_LE(std::abs(edge.weight), 1);
  }
}

// Whatever the angle, radial normals of a sphere are mirror images, and the weight is that of their distance.
TEST(AdjacentSites, AreMirrorImagesOnEveryArc) {
  const Sites sites = ends_of_axes(1.5);
  const std::vector<SignEdge> edges = adjacent_sites(sites);
  EXPECT_EQ(edges.size(), 15U);
  for (const SignEdge& edge : edges) {
    const Vec3 d = vector::subtract(sites.axis[edge.b], sites.axis[edge.a]);
    EXPECT_NEAR(edge.weight, std::exp(-vector::dot(d, d) / (2 * 1.5 * 1.5 * 1.5 * 1.5)), 1e-12);
  }
}

// Neighbours on an arc are sqrt(2) apart, 3.5 distances; the opposite ends 5.
TEST(AdjacentSites, CrossNoGapOfMoreThanFourDistances) {
  Sites sites = ends_of_axes(0.4);
  EXPECT_EQ(adjacent_sites(sites).size(), 12U);
  sites.distance = 0.35;
  EXPECT_EQ(adjacent_sites(sites).size(), 0U);
}

TEST(AtSites, AreTheMeansOfTheirPointsOrTheAxis) {
  const shapes::Surface s = waves(2000);
  const Sites sites = place_sites(PointSet(s.points), 0.2);
  ASSERT_LT(sites.size(), 200U);
  const std::vector<Vec3> tilted(2000, Vec3{0.6, 0, 0.8});
  for (const Vec3& mean : at_sites(sites, tilted)) EXPECT_NEAR(vector::dot(mean, {0.6, 0, 0.8}), 1, 1e-12);
  EXPECT_EQ(at_sites(sites, std::vector<Vec3>(2000, Vec3{0, 0, 0})), sites.axis);
}

TEST(SidesByAgreement, OfASurfaceWithoutAnInsideAreOneSideAtEveryScale) {
  const shapes::Surface s = waves(4000);
  const PointSet set(s.points);
  const std::vector<std::vector<Vec3>> all = sides_by_agreement(set, place_sites(set, 0), sum_plan(1e-2, 4000), nullptr);
  ASSERT_EQ(all.size(), 3U);
  for (const std::vector<Vec3>& normals : all) {
    const double up = share_up(normals);
    EXPECT_EQ(std::max(up, 1 - up), 1);
    for (std::size_t i = 0; i < normals.size(); ++i)
      EXPECT_EQ(std::abs(vector::dot(normals[i], all[0][i])), vector::dot(all[0][i], all[0][i]));
  }
  EXPECT_GT(up_to_sign(all[0], s.normals), 0.99);
}

// Single wrong points do not change what is seen of the rest from four spacings away.
TEST(SeenFromAfar, FollowsWhatIsAround) {
  const shapes::Surface s = waves(4000);
  const PointSet set(s.points);
  std::vector<Vec3> normals = s.normals;
  for (std::size_t i = 0; i < normals.size(); i += 20) normals[i] = vector::scale(normals[i], -1);
  EXPECT_EQ(share_up(seen_from_afar(set, place_sites(set, 0), normals, sum_plan(1e-2, 4000), nullptr)), 1);
}

}  // namespace
}  // namespace g3r
