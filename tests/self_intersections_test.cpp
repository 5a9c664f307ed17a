// Pairs of triangles that intersect, and the exact signs behind them.
#include <g3r/mesh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "mesh/box_tree.h"
#include "mesh/exact_orientation.h"
#include "mesh_shapes.h"

namespace g3r {
namespace {

// Small integers, scaled and moved: the determinant of the integers themselves is exact.
TEST(ExactOrientation, AgreesWithIntegers) {
  std::mt19937_64 rng(1);
  std::uniform_int_distribution<long> coordinate(-8, 8);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<std::array<long, 3>, 4> k{};
    std::array<Vec3, 4> p{};
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t a = 0; a < 3; ++a) {
        k[j][a] = coordinate(rng);
        p[j][a] = std::ldexp(static_cast<double>(k[j][a]) + 0x1p30, -20);  // a common offset that rounding must not spoil
      }
    }
    const auto d = [&](std::size_t j, std::size_t a) { return k[j][a] - k[0][a]; };
    const long det = d(3, 0) * (d(1, 1) * d(2, 2) - d(1, 2) * d(2, 1)) + d(3, 1) * (d(1, 2) * d(2, 0) - d(1, 0) * d(2, 2)) +
                     d(3, 2) * (d(1, 0) * d(2, 1) - d(1, 1) * d(2, 0));
    EXPECT_EQ(orientation(p[0], p[1], p[2], p[3]), det > 0 ? 1 : det < 0 ? -1 : 0);
    zeros += det == 0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 10);
}

TEST(ExactOrientation, SeesTheLastBit) {
  const Vec3 a{0.1, 0.1, 0.1}, b{0.7, 0.7, 0.7}, c{0.3, 0.9, 0.3};
  const double z = 1.0 / 3;  // a, b, c lie in the plane x = z
  EXPECT_EQ(orientation(a, b, c, {z, 5, z}), 0);
  const int above = orientation(a, b, c, {z, 5, std::nextafter(z, 1)}), below = orientation(a, b, c, {z, 5, std::nextafter(z, 0)});
  EXPECT_EQ(above * below, -1);
  EXPECT_EQ(orientation_along(1, a, b, {z, 5, z}), 0);
  EXPECT_EQ(orientation_along(1, a, b, {z, 5, std::nextafter(z, 1)}) * orientation_along(1, a, b, {z, 5, std::nextafter(z, 0)}), -1);
}

// Every pair once, for numbers around the sizes of leaves and above; many boxes have equal centres.
TEST(BoxTree, FindsThePairsThatMeet) {
  std::mt19937_64 rng(1);
  for (const std::size_t count : {1, 2, 5, 6, 7, 12, 13, 100, 1000}) {
    std::uniform_int_distribution<int> place(0, 9), size(0, 2);
    std::vector<mesh::FloatBox> boxes(count);
    for (mesh::FloatBox& box : boxes) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = static_cast<float>(place(rng));
        box.high[k] = box.low[k] + static_cast<float>(size(rng));
      }
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> expected, found;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t j = i + 1; j < count; ++j) {
        bool common = true;
        for (std::size_t k = 0; k < 3; ++k) {
          common = common && std::max(boxes[i].low[k], boxes[j].low[k]) <= std::min(boxes[i].high[k], boxes[j].high[k]);
        }
        if (common) expected.emplace_back(i, j);
      }
    }
    const mesh::BoxTree tree(boxes);
    for (const mesh::BoxTree::PairJob& job : tree.pair_jobs()) {
      tree.visit_pairs(job, [&](std::uint32_t i, std::uint32_t j) { found.emplace_back(i, j); });
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << count;
  }
}

// Rounding to float must not hide a pair: neighbours on a fine grid far from the origin.
TEST(SelfIntersections, FoundFarFromTheOrigin) {
  Mesh m;
  for (int i = 0; i < 20; ++i) {
    const double x = 1e6 + i * 1e-6;
    const auto first = static_cast<std::uint32_t>(m.vertices.size());
    for (const Vec3& p : {Vec3{x, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}, Vec3{x - 2e-7, 0.2, 0.2}, Vec3{x + 2e-7, 0.2, 0.2}, Vec3{x, 2, 2}}) {
      m.vertices.push_back(p);
    }
    m.triangles.push_back({first, first + 1, first + 2});
    m.triangles.push_back({first + 3, first + 4, first + 5});
  }
  EXPECT_EQ(count_self_intersections(m), 20U);
}

// Coordinates of a projection: 4,000 km from the origin every triangle of this mesh is smaller than the last digit of float.
TEST(SelfIntersections, TakeNoLongerFarFromTheOrigin) {
  Mesh here = shapes::united(shapes::sphere(1, 300), shapes::moved(shapes::sphere(1, 300), {0.5, 0, 0}));
  for (Vec3& v : here.vertices) {
    for (double& c : v) c = std::ldexp(std::round(std::ldexp(c, 24)), -24);  // moving rounds nothing
  }
  const auto seconds = [](const Mesh& mesh, std::size_t& count) {
    const auto start = std::chrono::steady_clock::now();
    count = count_self_intersections(mesh);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::size_t count = 0, far_count = 0;
  const double near = seconds(here, count), far = seconds(shapes::moved(here, {0x1p19, 0x1p22, 0x1p8}), far_count);
  EXPECT_GT(count, 100U);
  EXPECT_EQ(far_count, count);
  EXPECT_LT(far, 5 * near + 1);
}

TEST(SelfIntersections, CleanShapesHaveNone) {
  EXPECT_EQ(count_self_intersections({}), 0U);
  EXPECT_EQ(count_self_intersections(shapes::tetrahedron()), 0U);
  EXPECT_EQ(count_self_intersections(shapes::cube()), 0U);
  EXPECT_EQ(count_self_intersections(shapes::sphere(1, 64)), 0U);
  EXPECT_EQ(count_self_intersections(shapes::torus(1, 0.4, 60, 40)), 0U);
  EXPECT_EQ(count_self_intersections(shapes::moved(shapes::sphere(1, 32), {1e6, -1e6, 1e6})), 0U);
  EXPECT_EQ(count_self_intersections(shapes::moved(shapes::sphere(1, 32), {0, 0, 0}, 1e-40)), 0U);
}

// Faces x + y + z = 1 and the three of the other tetrahedron around its tip: the tip pierces one face, so three pairs meet.
TEST(SelfIntersections, ATipThroughAFaceMeetsItWithThreeTriangles) {
  const Mesh pierced = shapes::united(shapes::tetrahedron(), shapes::moved(shapes::inverted(shapes::tetrahedron()), {0.3, 0.3, 0.3}));
  EXPECT_EQ(count_self_intersections(pierced), 3U);
  EXPECT_EQ(count_self_intersections(shapes::united(shapes::tetrahedron(), shapes::moved(shapes::tetrahedron(), {0.4, 0.4, 0.4}))), 0U);
}

TEST(SelfIntersections, TouchingCountsAMissByOneBitDoesNot) {
  const auto tip = [](double z) {  // its lowest vertex at height z over the middle of a triangle in z = 0
    Mesh m;
    m.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0.7, 0.9, z}, {1, 1, 2}, {0.5, 1, 2}};
    m.triangles = {{0, 1, 2}, {3, 4, 5}};
    return m;
  };
  EXPECT_EQ(count_self_intersections(tip(0)), 1U);
  EXPECT_EQ(count_self_intersections(tip(0x1p-300)), 0U);
  EXPECT_EQ(count_self_intersections(tip(-0x1p-60)), 1U);
}

TEST(SelfIntersections, CoplanarTrianglesThatOverlapMeet) {
  Mesh m;
  m.vertices = {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}, {1, 1, 1}, {1.5, 1, 1}, {1, 1.5, 1}, {3, 3, 1}, {4, 3, 1}, {3, 4, 1}};
  m.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};  // the second inside the first, the third beside it
  EXPECT_EQ(count_self_intersections(m), 1U);
}

// A strip of three quads, the last of which comes back through the first.
TEST(SelfIntersections, AFoldedStripIsFound) {
  Mesh m;
  const std::array<std::array<double, 2>, 4> profile = {{{0, 0}, {2, 0}, {2, 1}, {1, -1}}};
  for (const auto& [x, z] : profile) {
    m.vertices.push_back({x, 0, z});
    m.vertices.push_back({x, 1, z});
  }
  for (std::uint32_t i = 0; i < 6; i += 2) {
    m.triangles.push_back({i, i + 2, i + 3});
    m.triangles.push_back({i, i + 3, i + 1});
  }
  EXPECT_GE(count_self_intersections(m), 2U);
  m.vertices[6][2] = m.vertices[7][2] = 0.5;  // folded over, but not through
  EXPECT_EQ(count_self_intersections(m), 0U);
}

TEST(MeshShape, AnglesAndAspectOfKnownTriangles) {
  const MeshCheck cube = check_mesh(shapes::cube());
  EXPECT_NEAR(cube.min_angle, 45, 1e-12);
  EXPECT_NEAR(cube.median_min_angle, 45, 1e-12);
  EXPECT_NEAR(cube.max_aspect, 2, 1e-12);
  Mesh sliver;
  sliver.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-3, 0}};
  sliver.triangles = {{0, 1, 2}};
  EXPECT_NEAR(check_mesh(sliver).max_aspect, 1000, 1e-6);
  EXPECT_NEAR(check_mesh(sliver).min_angle, std::atan(2e-3) * 180 / shapes::kPi, 1e-9);
  sliver.vertices[2][1] = 0;
  EXPECT_EQ(check_mesh(sliver).min_angle, 0);
  EXPECT_TRUE(std::isinf(check_mesh(sliver).max_aspect));
}

}  // namespace
}  // namespace g3r
