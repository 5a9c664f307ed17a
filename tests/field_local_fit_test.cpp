#include "mesh/field_local_fit.h"

#include "mesh/smooth_spacing.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r::mesh {
namespace {

OrientedPoints oriented(const shapes::Surface& surface) { return {surface.points, surface.normals, smooth_spacing(surface.points)}; }

// A square of the given height facing up or down.
void add_square(OrientedPoints& points, double z, double up) {
  for (int i = 0; i < 40 * 40; ++i) {
    points.positions.push_back({0.05 * (i % 40), 0.05 * (i / 40), z});
    points.normals.push_back({0, 0, up});
    points.spacing.push_back(0.05);
  }
}

TEST(LocalFit, OfAPlaneIsThePlane) {
  OrientedPoints points;
  add_square(points, 0.5, 1);
  const Neighbours neighbours(points.positions);
  const std::vector<std::uint32_t> near = neighbours.of_all(17);
  const LocalFit local(points, neighbours, near);
  for (const double z : {0.45, 0.5, 0.56}) {
    const LocalSurface surface = local.fit({1.01, 0.98, z}, 4);
    ASSERT_EQ(surface.count, 1);
    EXPECT_NEAR(surface.distance({1.01, 0.98, z}), z - 0.5, 1e-9);
    EXPECT_FALSE(surface.walls);
  }
}

TEST(LocalFit, OfASphereHasItsDistance) {
  const OrientedPoints points = oriented(shapes::sphere(3000));
  const Neighbours neighbours(points.positions);
  const std::vector<std::uint32_t> near = neighbours.of_all(17);
  const LocalFit local(points, neighbours, near);
  shapes::Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d x = to_eigen(random.direction()) * 0.92;
    const LocalSurface surface = local.fit(x, 4);
    ASSERT_GT(surface.count, 0);
    EXPECT_NEAR(surface.distance(x), 0.02, 2e-3);  // the height field is of second order
  }
}

TEST(LocalFit, HasNoPatchBeyondItsReach) {
  OrientedPoints points;
  add_square(points, 0, 1);
  const Neighbours neighbours(points.positions);
  const std::vector<std::uint32_t> near = neighbours.of_all(17);
  EXPECT_EQ(LocalFit(points, neighbours, near).fit({1, 1, 0.5}, 4).count, 0);
}

TEST(WallThickness, IsTheDistanceOfWallsThatFaceApart) {
  OrientedPoints points;
  add_square(points, 0, -1);
  add_square(points, 0.04, 1);
  const std::vector<std::uint32_t> near = Neighbours(points.positions).of_all(17);
  for (const double thickness : wall_thickness(points, near)) EXPECT_NEAR(thickness, 0.04, 1e-12);
  OrientedPoints single;
  add_square(single, 0, 1);
  for (const double thickness : wall_thickness(single, Neighbours(single.positions).of_all(17))) EXPECT_TRUE(std::isinf(thickness));
}

}  // namespace
}  // namespace g3r::mesh
