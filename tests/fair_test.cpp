// Fair surface where points lie in lines.
#include "mesh/fair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloud/neighbours.h"
#include "field_shapes.h"
#include "mesh/field_mesher.h"
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

}  // namespace
