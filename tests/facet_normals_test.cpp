// Normals of points of flat facets: exact on them, the likeliest mean at their edges, and the sides stay.
#include "orient/facet_normals.h"

#include "base/vector.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr double kSpacing = 0.02;

// Two half planes that meet in an edge along z, x >= 0 of normal -y and the other turned by `angle` about the edge, and noise.
Surface two_facets(double angle, double sigma) {
  const Vec3 along{std::cos(angle), std::sin(angle), 0};
  Surface s;
  shapes::Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const double far = random.uniform(0, 1), high = random.uniform(0, 1);
    const bool is_first = i % 2 == 0;
    Vec3 p = is_first ? Vec3{far, 0, high} : Vec3{far * along[0], far * along[1], high};
    for (double& c : p) c += sigma * random.gaussian();
    s.points.push_back(p);
    s.normals.push_back(is_first ? Vec3{0, -1, 0} : Vec3{-along[1], along[0], 0});
  }
  return s;
}

double from_edge(const Vec3& p) { return std::hypot(p[0], p[1]); }

// What fits from all around leave: nothing proven up to half a spacing from the edge, where normals are the mean of both facets'.
struct Start {
  std::vector<Vec3> normals;
  std::vector<std::uint8_t> proven;
};

Start blurred(const Surface& s) {
  Start start{s.normals, std::vector<std::uint8_t>(s.points.size(), 1)};
  const Vec3 mean = vector::normalised(vector::add(s.normals[0], s.normals[1]));
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (from_edge(s.points[i]) >= kSpacing / 2) continue;
    start.normals[i] = mean;
    start.proven[i] = 0;
  }
  return start;
}

std::vector<Vec3> followed(const Surface& s, double sigma, const Start& start) {
  std::vector<Vec3> normals = start.normals;
  const PointSet set(s.points);
  follow_facets(set, find_facets(set, start.proven, normals, sigma), {}, normals);
  return normals;
}

// Mean (1 - cosine) / 2 of the points less than `reach` from the edge.
double error_within(double reach, const Surface& s, const std::vector<Vec3>& normals) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (from_edge(s.points[i]) >= reach) continue;
    sum += (1 - vector::dot(normals[i], s.normals[i])) / 2;
    ++count;
  }
  return sum / count;
}

TEST(FacetNormals, AreThoseOfTheFacetUpToTheNoiseFromItsEdge) {
  for (const double angle : {std::numbers::pi / 3, std::numbers::pi / 2, 2 * std::numbers::pi / 3}) {
    for (const double sigma : {0.0, 0.01 * kSpacing, 0.1 * kSpacing}) {
      const Surface s = two_facets(angle, sigma);
      const std::vector<Vec3> normals = followed(s, sigma, blurred(s));
      std::size_t far = 0, exact = 0;
      for (std::size_t i = 0; i < s.points.size(); ++i) {
        if (from_edge(s.points[i]) * std::sin(angle) <= std::max(5 * sigma, 0.005 * kSpacing)) continue;
        const double cosine = vector::dot(normals[i], s.normals[i]);
        EXPECT_GT(cosine, 0.9) << angle << ' ' << sigma << ' ' << i;
        ++far;
        exact += cosine > 0.999 ? 1 : 0;
      }
      EXPECT_GT(static_cast<double>(exact), 0.995 * static_cast<double>(far)) << angle << ' ' << sigma;
    }
  }
}

// Within the noise of an edge nothing tells of which facet a point is: the posterior mean has a lesser error than the nearest plane.
TEST(FacetNormals, AtAnEdgeErrLessThanThoseOfTheNearestFacet) {
  const double sigma = 0.1 * kSpacing;
  const Surface s = two_facets(std::numbers::pi / 2, sigma);
  std::vector<Vec3> nearest;
  for (const Vec3& p : s.points) nearest.push_back(std::abs(p[1]) < std::abs(p[0]) ? Vec3{0, -1, 0} : Vec3{-1, 0, 0});
  const std::vector<Vec3> normals = followed(s, sigma, blurred(s));
  EXPECT_LT(error_within(2 * sigma, s, normals), 0.9 * error_within(2 * sigma, s, nearest));
  EXPECT_LT(error_within(kSpacing, s, normals), 0.5 * error_within(kSpacing, s, blurred(s).normals));
}

TEST(FacetNormals, TurnWithTheSidesThatAreGiven) {
  const double sigma = 0.1 * kSpacing;
  const Surface s = two_facets(std::numbers::pi / 2, sigma);
  Start start = blurred(s);
  const std::vector<Vec3> normals = followed(s, sigma, start);
  for (Vec3& n : start.normals) n = vector::scale(n, -1);
  const std::vector<Vec3> turned = followed(s, sigma, start);
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_EQ(turned[i], vector::scale(normals[i], -1));
}

TEST(FacetNormals, OfAThinWallKeepTheirSides) {
  const double sigma = 0.02 * kSpacing;
  Surface wall = shapes::plates(1, 1, 0.3, 5, kSpacing);
  shapes::scatter(wall, sigma);
  const std::vector<Vec3> normals = followed(wall, sigma, {wall.normals, std::vector<std::uint8_t>(wall.points.size(), 1)});
  EXPECT_GT(shapes::share_correct(normals, wall.normals), 0.998);
}

TEST(FacetNormals, OfCurvedSurfacesStay) {
  const Surface sphere = shapes::sphere(5000);
  const std::vector<Vec3> normals = followed(sphere, 0, {sphere.normals, std::vector<std::uint8_t>(sphere.points.size(), 1)});
  EXPECT_EQ(normals, sphere.normals);
}

TEST(FacetNormals, OfPointsThatAreNotWantedStay) {
  const Surface s = two_facets(std::numbers::pi / 2, 0.1 * kSpacing);
  const Start start = blurred(s);
  std::vector<std::uint8_t> wanted(s.points.size(), 0);
  for (std::size_t i = 0; i < wanted.size() / 2; ++i) wanted[i] = 1;
  std::vector<Vec3> normals = start.normals;
  const PointSet set(s.points);
  follow_facets(set, find_facets(set, start.proven, normals, 0.1 * kSpacing, wanted), wanted, normals);
  EXPECT_NE(normals, start.normals);
  for (std::size_t i = wanted.size() / 2; i < wanted.size(); ++i) EXPECT_EQ(normals[i], start.normals[i]);
}

}  // namespace
}  // namespace g3r
