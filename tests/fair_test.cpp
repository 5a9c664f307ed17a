// Fair surface where points lie in lines.
#include "mesh/fair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "cloud/neighbours.h"
#include "field_shapes.h"
#include "mesh/field_mesher.h"
#include "mesh/field_points.h"
#include "mesh/least_squares_mesh.h"
#include "mesh/lines.h"
#include "mesh_topology.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

constexpr double kRadius = 1, kTube = 0.4;

double distance_to_torus(const Vec3& p) { return std::hypot(std::hypot(p[0], p[1]) - kRadius, p[2]) - kTube; }

// Rings around the tube of a torus, far closer along than across.
OrientedSample torus_of_rings(int rings, int points) {
  OrientedSample out;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < points; ++j) {
      const double u = 2 * std::numbers::pi * i / rings, v = 2 * std::numbers::pi * j / points;
      const double r = kRadius + kTube * std::cos(v);
      out.points.push_back({r * std::cos(u), r * std::sin(u), kTube * std::sin(v)});
      out.normals.push_back({std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)});
    }
  }
  return out;
}

std::size_t marked(const std::vector<Vec3>& points) {
  const std::vector<std::uint8_t> in_lines = mesh::points_in_lines(points, Neighbours(points).of_all(16));
  return static_cast<std::size_t>(std::count(in_lines.begin(), in_lines.end(), std::uint8_t{1}));
}

TEST(Fair, LinesAreFoundAndSurfacesAreNot) {
  const OrientedSample torus = torus_of_rings(16, 60);
  EXPECT_EQ(marked(torus.points), torus.points.size());
  EXPECT_EQ(marked(sphere_sample(5000, 1, 1).points), 0U);
  EXPECT_EQ(marked(cube_sample(5000, 1, 1).points), 0U);
}

// Unlike the surfaces of random samples, of which each point stands for a disc.
TEST(Fair, LinesHoldSurfaceHalfWayToTheNext) {
  OrientedSample lines;
  constexpr double kApart = 9;  // the 8 nearest of the last point of a line are on it
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 200; ++j) lines.points.push_back({double(j), kApart * i, 0});
  }
  for (const double h : mesh::spacing_across_lines(lines.points, std::vector<double>(lines.points.size(), 1))) EXPECT_EQ(h, 0.5 * kApart);
  const std::vector<Vec3> random = sphere_sample(5000, 1, 1).points;
  const std::vector<double> spacing(random.size(), 1e-3);
  EXPECT_EQ(mesh::spacing_across_lines(random, spacing), spacing);
}

// The mean squared distance from the torus between its rings is that of the bend that the field misses.
TEST(Fair, SurfaceBetweenLinesGoesOnAsItBends) {
  const OrientedSample torus = torus_of_rings(16, 60);
  DistanceSampler field(distance_to_torus, 0.1);
  const Mesh mesh = field_mesh(torus.points, torus.normals, field);
  const Topology t = topology(mesh);
  EXPECT_EQ(t.bad_edges, 0U);
  EXPECT_EQ(t.genus, 1);
  double worst = 0;
  for (const Vec3& v : mesh.vertices) worst = std::max(worst, std::abs(distance_to_torus(v)));
  EXPECT_LT(worst, 0.03);
}

// A vertex that was pulled out of a sphere of lines returns, and the points stay on the surface.
TEST(Fair, ThornsGo) {
  OrientedSample sphere;
  for (int i = 1; i < 12; ++i) {
    for (int j = 0; j < 100; ++j) {
      const double u = std::numbers::pi * i / 12, v = 2 * std::numbers::pi * j / 100;
      const Vec3 p{std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u)};
      sphere.points.push_back(p);
      sphere.normals.push_back(p);
    }
  }
  const auto norm = [](const Vec3& p) { return std::hypot(p[0], p[1], p[2]); };
  DistanceSampler field([&](const Vec3& p) { return norm(p) - 1; }, 0.1);
  Mesh mesh = field_mesh(sphere.points, sphere.normals, field);
  for (std::size_t v = 0; v < mesh.vertices.size(); v += 50) {
    for (double& c : mesh.vertices[v]) c *= 1.1;
  }
  mesh::make_fair(mesh, sphere.points, std::vector<std::uint8_t>(sphere.points.size(), 1));
  for (const Vec3& v : mesh.vertices) EXPECT_NEAR(norm(v), 1, 0.04);
  const std::vector<Vec3> before = mesh.vertices;
  mesh::make_fair(mesh, sphere.points, std::vector<std::uint8_t>(sphere.points.size(), 0));
  EXPECT_EQ(mesh.vertices, before);
}

// Of the points of a curve every other one faces the other way, as if it were thin.
TEST(Fair, LinesAreNoWallsToThemselves) {
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.1 * i;
    points.push_back({5 * std::cos(t), 5 * std::sin(t), t});
    normals.push_back({0, 0, i % 2 == 0 ? 1.0 : -1.0});
  }
  const auto sizes = [&](std::size_t count, bool told) {
    mesh::Prepared prepared;
    mesh::prepare({points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count)},
                  {normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(count)}, 0, prepared);
    const std::vector<std::uint8_t> in_lines = mesh::points_in_lines(prepared.points.positions, prepared.near);
    EXPECT_EQ(std::count(in_lines.begin(), in_lines.end(), std::uint8_t{1}), static_cast<std::ptrdiff_t>(count));
    std::vector<double> out = told ? mesh::sizes_to_resolve(prepared, in_lines) : mesh::sizes_to_resolve(prepared);
    for (std::size_t i = 0; i < count; ++i) out[i] /= prepared.points.spacing[i];
    return out;
  };
  EXPECT_EQ(sizes(400, true), std::vector<double>(400, 1));
  for (const double size : sizes(400, false)) EXPECT_LT(size, 0.8);
  EXPECT_EQ(sizes(10, true), sizes(10, false));  // by chance
}

// A square grid in the plane, z = 0 but where it is moved.
Mesh grid(std::uint32_t side) {
  Mesh mesh;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) mesh.vertices.push_back({double(x), double(y), 0});
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t v = side * y + x;
      mesh.triangles.push_back({v, v + 1, v + side});
      mesh.triangles.push_back({v + 1, v + side + 1, v + side});
    }
  }
  return mesh;
}

TEST(VertexRings, HaveEveryNeighbourOnceAscending) {
  const mesh::VertexRings rings = mesh::vertex_rings(grid(3));
  const auto middle = rings.of(4);
  EXPECT_EQ(std::vector<std::uint32_t>(middle.begin(), middle.end()), (std::vector<std::uint32_t>{1, 2, 3, 5, 6, 7}));
  EXPECT_EQ(rings.of(0).size(), 2U);
}

// Each Laplacian is 0 in a plane. An anchor above it pulls its vertex up, no farther than to itself, and the others stay.
TEST(LeastSquaresMesh, IsFlatWithoutAnchorsAndMovesTowardsThem) {
  constexpr std::uint32_t side = 7, middle = side * side / 2;
  const Mesh flat = grid(side);
  const mesh::VertexRings rings = mesh::vertex_rings(flat);
  std::vector<std::uint8_t> free(flat.vertices.size(), 0);
  for (std::uint32_t v = 0; v < free.size(); ++v) {
    const std::uint32_t x = v % side, y = v / side;
    free[v] = x > 1 && y > 1 && x + 2 < side && y + 2 < side ? 1 : 0;
  }
  std::vector<Vec3> at = flat.vertices;
  at[middle] = {3.3, 2.9, 1};
  std::optional<double> enough;
  mesh::LeastSquaresMesh(rings, free).minimise({}, at, enough, nullptr);
  for (std::size_t v = 0; v < at.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(at[v][a], flat.vertices[v][a], 1e-3);
  }
  const mesh::Anchor above{{middle, middle + 1, middle + side}, {1, 0, 0}, {3, 3, 1}};
  mesh::LeastSquaresMesh(rings, free).minimise({above}, at, enough, nullptr);
  EXPECT_GT(at[middle][2], 0.1);
  EXPECT_LT(at[middle][2], 1);
  EXPECT_EQ(at[0], flat.vertices[0]);
}

}  // namespace
