#include "mesh/field_local_fit.h"

#include "base/vector.h"
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

// Random points, one for an area of h = 0.05 squared, in the plane through `origin` along u and v, from (0, 0) to (su, sv).
void add_patch(OrientedPoints& points, shapes::Random& random, const Vec3& origin, const Vec3& u, const Vec3& v, double su, double sv) {
  constexpr double h = 0.05;
  const Vec3 normal = vector::cross(u, v);
  for (int i = 0; i < std::lround(su * sv / (h * h)); ++i) {
    const double s = su * random.uniform(), t = sv * random.uniform();
    points.positions.push_back({origin[0] + s * u[0] + t * v[0], origin[1] + s * u[1] + t * v[1], origin[2] + s * u[2] + t * v[2]});
    points.normals.push_back(normal);
    points.spacing.push_back(h);
  }
}

// Two blocks below z = 0 with a slot between x = 0 and x = gap. With normals turned it is a wall between floors.
OrientedPoints slot(double gap, double turn) {
  shapes::Random random(7);
  OrientedPoints points;
  add_patch(points, random, {-0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5, 10);
  add_patch(points, random, {gap, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5, 10);
  add_patch(points, random, {0, 0, -0.5}, {0, 1, 0}, {0, 0, 1}, 10, 0.5);
  add_patch(points, random, {gap, 0, -0.5}, {0, 0, 1}, {0, 1, 0}, 0.5, 10);
  for (Vec3& n : points.normals) n = {turn * n[0], turn * n[1], turn * n[2]};
  return points;
}

// In the mouth of a slot, and in a wall where it leaves the floor, a place 0.25 spacings and more from all surface is rarely on the wrong
// side: only where the 16 points have nothing of one wall, and the other patches look like an edge.
TEST(LocalFit, TheMouthOfASlotIsOpenAndTheFootOfAWallIsSolid) {
  constexpr double h = 0.05;
  for (const double turn : {1.0, -1.0}) {
    const OrientedPoints points = slot(h, turn);
    const Neighbours neighbours(points.positions);
    const std::vector<std::uint32_t> near = neighbours.of_all(32);
    const LocalFit local(points, neighbours, near);
    int asked = 0, wrong = 0;
    for (double y = 0.5; y < 9.5; y += h / 2) {
      for (const double x : {-0.6, -0.3, 0.25, 0.5, 0.75, 1.3, 1.6}) {
        const Eigen::Vector3d place{x * h, y, -0.3 * h};
        const LocalSurface fit = local.fit(place, 1.8);
        ASSERT_GT(fit.count, 0);
        if (fit.unjoined) continue;
        ++asked;
        wrong += (turn * fit.distance(place) > 0) == (x > 0 && x < 1) ? 0 : 1;
      }
    }
    EXPECT_GT(asked, 2000);
    EXPECT_LT(wrong, asked / 200) << "thirty times as many where what is beyond a wall counts for it";
  }
}

// One wall and a floor that goes on behind it, as where the other wall of a slot has no points: the floor is on both sides of the wall. An
// edge, where the floor ends, is joined.
TEST(LocalFit, ASurfaceOnBothSidesOfAnotherIsJoinedToNone) {
  for (const double beyond : {0.0, 0.5}) {
    shapes::Random random(8);
    OrientedPoints points;
    add_patch(points, random, {-0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5 + beyond, 1);
    add_patch(points, random, {0, 0, -0.5}, {0, 1, 0}, {0, 0, 1}, 1, 0.5);
    const Neighbours neighbours(points.positions);
    const std::vector<std::uint32_t> near = neighbours.of_all(32);
    const LocalSurface fit = LocalFit(points, neighbours, near).fit({0.01, 0.5, -0.02}, 1.8);
    ASSERT_EQ(fit.count, 2);
    EXPECT_EQ(fit.unjoined, beyond > 0);
    EXPECT_TRUE(beyond > 0 || fit.joint[0] == Joint::kConvex);
  }
}

// Points of two sides of a cube, seen from beside their edge: two patches and the edge between them.
TEST(LocalSurface, JoinsTheSidesOfAnEdgeAndLeavesOutAPointThatIsOfNeither) {
  std::vector<FitPoint> points;
  for (const double u : {-0.3, -0.1, 0.1, 0.3}) {
    for (const double v : {-0.1, -0.2}) {
      points.push_back({{u, v, 0}, {0, 0, 1}, 1});
      points.push_back({{u, 0, v}, {0, 1, 0}, 1});
    }
  }
  points.back() = {{0.1, -0.1, 0.01}, {1, 0, 0}, 1};
  const Eigen::Vector3d x(0, 0.02, 0.01);
  const LocalSurface surface = surface_through(points, 0.2, x);
  ASSERT_EQ(surface.count, 2);
  EXPECT_EQ(surface.joint[0], Joint::kConvex);
  EXPECT_FALSE(surface.walls);
  EXPECT_LT(points.back().patch, 0);
  EXPECT_NEAR(surface.distance(x), 0.02, 1e-6);
  std::vector<FitPoint> none;
  EXPECT_EQ(surface_through(none, 0.2, x).count, 0);
}

// Two walls, and beside their ends a single point between them. If it is square to both it is of the rim, and what is past it is outside.
TEST(LocalSurface, ASinglePointTellsWhereTwoWallsEnd) {
  for (const bool is_square : {true, false}) {
    std::vector<FitPoint> points;
    for (const double u : {-0.1, -0.2, -0.3}) {
      for (const double v : {-0.1, 0.1}) {
        points.push_back({{u, v, 0}, {0, 0, 1}, 1});
        points.push_back({{u, v, -0.1}, {0, 0, -1}, 1});
      }
    }
    points.push_back({{0, 0.25, -0.05}, is_square ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(0.8, 0, 0.6), 1});
    const Eigen::Vector3d x(0.04, 0, -0.05);
    const LocalSurface surface = surface_through(points, 0.2, x);
    EXPECT_TRUE(surface.walls);
    EXPECT_EQ(surface.count, is_square ? 3 : 2);
    EXPECT_NEAR(surface.distance(x), is_square ? 0.04 : -0.05, 1e-6);
  }
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
