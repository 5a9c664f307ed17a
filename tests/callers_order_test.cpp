// Results in the caller's order and units: values of a place come back to all points at that place.
#include "orient/callers_order.h"

#include "base/vector.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <vector>

namespace g3r {
namespace {

// Points of a sphere of radius 50 about (1000, 0, 0), one of them three times and one not finite.
std::vector<Vec3> cloud_of_caller() {
  std::vector<Vec3> points = shapes::sphere(200, 50, {1000, 0, 0}).points;
  points.insert(points.begin(), points[150]);
  points.push_back(points[0]);
  points.push_back({0, std::numeric_limits<double>::infinity(), 0});
  return points;
}

Vec3 normal_at(const Vec3& p) { return vector::normalised({p[0] - 1000, p[1], p[2]}); }

TEST(ToCallersOrder, EveryPointGetsWhatItsPlaceHas) {
  const std::vector<Vec3> points = cloud_of_caller();
  const CanonicalCloud cloud = canonical_cloud(points);
  const double area = 4;  // of every place, in squared units of the caller
  Solution solution;
  std::vector<float> confidence;
  for (const Vec3& unit : cloud.points()) {
    const Vec3 p = cloud.frame.to_world(unit);
    solution.refinement.normals.push_back(normal_at(p));
    solution.eta.push_back(vector::scale(normal_at(p), area * cloud.frame.scale * cloud.frame.scale));
    confidence.push_back(static_cast<float>((p[2] + 50) / 100));
  }
  Orientation out;
  to_callers_order(cloud, solution, confidence, out);
  ASSERT_EQ(out.normals.size(), points.size());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    EXPECT_NEAR(vector::dot(out.normals[i], normal_at(points[i])), 1, 1e-12);
    EXPECT_NEAR(out.confidence[i], (points[i][2] + 50) / 100, 1e-6);
    sum += out.areas[i];
  }
  EXPECT_NEAR(sum, 200 * area, 1e-9);
  EXPECT_NEAR(out.areas[0], area / 3, 1e-12);  // one of three twins
  EXPECT_EQ(out.normals.back(), (Vec3{0, 0, 0}));
  EXPECT_EQ(out.areas.back(), 0);
  EXPECT_EQ(out.confidence.back(), 0);
}

TEST(OpenInCallersOrder, MarksThePointsOfOpenSurfaces) {
  const std::vector<Vec3> points = cloud_of_caller();
  const CanonicalCloud cloud = canonical_cloud(points);
  OpenSurfaces surfaces;
  EXPECT_EQ(open_in_callers_order(cloud, surfaces), std::vector<std::uint8_t>(points.size(), 0));
  for (const Vec3& unit : cloud.points()) surfaces.part.push_back(cloud.frame.to_world(unit)[2] > 0 ? 0 : OpenSurfaces::kNone);
  const std::vector<std::uint8_t> open = open_in_callers_order(cloud, surfaces);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) EXPECT_EQ(open[i], points[i][2] > 0 ? 1 : 0) << i;
  EXPECT_EQ(open.back(), 0);
}

}  // namespace
}  // namespace g3r
