// Planes of CAD models whose points are almost exact.
#include "cloud/canonical_cloud.h"
#include "cloud/exact_plane.h"
#include "cloud/noise.h"
#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

constexpr double kSpacing = 0.02;

Surface scattered(Surface surface, double spacings) {
  shapes::scatter(surface, spacings * kSpacing);
  return surface;
}

double scatter_of(const Surface& surface) {
  const CanonicalCloud cloud = canonical_cloud(surface.points);
  return facet_scatter(cloud.set) / cloud.set.spacing();
}

// The spacing of the cloud differs by up to a tenth from that of the plates, and the ladder has steps of 2.
TEST(FacetScatter, IsThatOfBoxesAndOfWallsCloserThanTheSampling) {
  for (const double sigma : kSanitized ? std::vector{0.01} : std::vector{0.004, 0.01, 0.03, 0.05}) {
    const double box = scatter_of(scattered(shapes::plates(1, 1, 20, 5, kSpacing), sigma));
    EXPECT_GT(box, sigma / 2) << sigma;
    EXPECT_LT(box, 2 * sigma) << sigma;
  }
  const double wall = scatter_of(scattered(shapes::plates(1, 1, 1.4, 5, kSpacing), 0.02));
  EXPECT_GT(wall, 0.01);
  EXPECT_LT(wall, 0.04);
}

// Of fins five spacings long the 132 nearest points hold a quarter at most on one side, and both sides are one plane of a tenth of a
// spacing in scatter.
TEST(FacetScatter, IsThatOfSmallFins) {
  const double fins = scatter_of(scattered(shapes::plates(40, 5 * kSpacing, 0.2, 3, kSpacing), 0.005));
  EXPECT_GT(fins, 0.0025);
  EXPECT_LE(fins, 0.016);
}

// A cylinder is flat along its axis, and has as many points a little below a plane as on it.
TEST(FacetScatter, IsNoneOfSmoothSurfaces) {
  for (const double sigma : {0.0, 0.005, 0.02}) {
    Surface cylinder;
    shapes::Random random(9);
    for (int i = 0; i < 20000; ++i) {
      const double angle = random.uniform(0, 2 * std::numbers::pi);
      cylinder.points.push_back(
          {std::cos(angle), std::sin(angle), random.uniform(0, 20000 * kSpacing * kSpacing / (2 * std::numbers::pi))});
      cylinder.normals.push_back({std::cos(angle), std::sin(angle), 0});
    }
    EXPECT_EQ(scatter_of(scattered(cylinder, sigma)), 0) << sigma;
  }
}

TEST(FacetScatter, IsNoneWhereFewPointsAreOnPlanes) {
  EXPECT_EQ(scatter_of(shapes::torus(8000, 0.6, 0.25, 3)), 0);
  Surface torus = shapes::torus(8000, 0.6, 0.25, 3);
  shapes::scatter(torus, 0.4 * 0.03);
  EXPECT_EQ(scatter_of(torus), 0);
}

// A point of a ridge is held by the plane of its own side, as far as its distance from the other's distinguishes them.
TEST(ScatteredPlane, OfTwoThatMeetIsThatOfThePointsOwnSide) {
  constexpr double kScatter = 0.02;
  shapes::Random random(5);
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
  for (int i = 0; i < 4000; ++i) {
    const bool top = i % 2 == 0;
    const double across = random.uniform(0, 20);
    const double noise = kScatter * random.gaussian();
    points.push_back(top ? Vec3{-across, random.uniform(-20, 20), noise} : Vec3{noise, random.uniform(-20, 20), -across});
    normals.push_back(top ? Vec3{0, 0, 1} : Vec3{1, 0, 0});
  }
  const Neighbours tree(points);
  const Vec3 between{std::sqrt(0.5), 0, std::sqrt(0.5)};  // what a field as wide as the spacing would say
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  int asked = 0, right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double away = std::max(-points[i][0], -points[i][2]);
    if (away < 4 * kScatter || away > 1.5 || std::abs(points[i][1]) > 18) continue;
    tree.nearest(points[i], kPlaneNeighbours, index, squared);
    const ExactPlane plane = find_scattered_plane(points, index, 1, kScatter, between);
    ++asked;
    right += std::abs(plane.normal[0] * normals[i][0] + plane.normal[2] * normals[i][2]) > 0.999 ? 1 : 0;
  }
  ASSERT_GT(asked, 200);
  EXPECT_GT(right, asked * 8 / 10);
}

TEST(ScatteredPlane, IsNoneOnABend) {
  const Surface sphere = shapes::sphere(4000);  // radius 18 spacings
  const double h = std::sqrt(4 * 3.14159 / 4000);
  const Neighbours tree(sphere.points);
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  int found = 0;
  for (std::size_t i = 0; i < 4000; i += 10) {
    tree.nearest(sphere.points[i], kPlaneNeighbours, index, squared);
    found += find_scattered_plane(sphere.points, index, h, 0.02 * h, sphere.normals[i]).points.empty() ? 0 : 1;
  }
  EXPECT_LT(found, 8);  // of 400
}

// From exact points to those that count as noisy the error of a whole run is that of the points within the scatter of an edge, 0.16 of the
// scatter in spacings of all: no step of the program makes it leap.
TEST(ScatteredPlane, ErrorsOfABoxGrowInProportionToTheScatter) {
  for (const double sigma : kSanitized ? std::vector{0.02, 0.035} : std::vector{0.0, 0.005, 0.01, 0.02, 0.035, 0.05}) {
    const Surface box = scattered(shapes::plates(1, 0.7, 12, 5, kSpacing), sigma);
    EXPECT_LT(shapes::angle_error(orient(box.points).normals, box.normals), 2e-5 + 0.05 * sigma) << sigma;
  }
}

}  // namespace
}  // namespace g3r
