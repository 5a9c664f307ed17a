// Triangles as large as the points can carry.
#include "mesh/coarsen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "field_shapes.h"
#include "mesh/field_mesher.h"
#include "mesh/quadric.h"
#include "mesh_topology.h"
#include "sanitized.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

constexpr int kSide = 40;

// Both sides of a plate, on a grid of unit step; no points on the rim.
OrientedSample plate(double thickness) {
  OrientedSample out;
  for (const double up : {1.0, -1.0}) {
    for (int x = 0; x < kSide; ++x) {
      for (int y = 0; y < kSide; ++y) {
        out.points.push_back({double(x), double(y), 0.5 * up * thickness});
        out.normals.push_back({0, 0, up});
      }
    }
  }
  return out;
}

DistanceSampler plate_field(double thickness) {
  const auto distance = [=](const Vec3& p) {
    const double middle = 0.5 * (kSide - 1);
    return std::max({std::abs(p[2]) - 0.5 * thickness, std::abs(p[0] - middle) - middle, std::abs(p[1] - middle) - middle});
  };
  return {distance, 0.05};
}

// A quarter of a step and half of one are thinner than plain leaves, a whole one is not.
TEST(Coarsen, ThinPlatesHaveAsFewTrianglesAsThickOnes) {
  for (const double thickness : kSanitized ? std::vector{0.5} : std::vector{0.25, 0.5, 1.0}) {
    const OrientedSample sample = plate(thickness);
    const Mesh mesh = field_mesh(sample.points, sample.normals, plate_field(thickness));
    const Topology t = topology(mesh);
    EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U);
    EXPECT_EQ(t.components, 1U);
    EXPECT_EQ(t.genus, 0);
    EXPECT_LE(mesh.triangles.size(), 6 * sample.points.size()) << thickness;
    for (const Vec3& v : mesh.vertices) {
      const bool inner = v[0] > 2 && v[0] < kSide - 3 && v[1] > 2 && v[1] < kSide - 3;
      EXPECT_TRUE(!inner || std::abs(std::abs(v[2]) - 0.5 * thickness) < 0.02) << v[2];
    }
  }
}

// Where no length is given, and where the surface bends.
TEST(Coarsen, WhatIsNotFlatStays) {
  const OrientedSample sphere = sphere_sample(500, 1, 1);
  const DistanceSampler field([](const Vec3& p) { return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1; }, 0.1);
  Mesh mesh = field_mesh(sphere.points, sphere.normals, field);
  const Mesh before = mesh;
  mesh::coarsen(mesh, sphere.points, std::vector<double>(500, 0));
  EXPECT_EQ(mesh.triangles, before.triangles);
  mesh::coarsen(mesh, sphere.points, std::vector<double>(500, 0.5));
  EXPECT_EQ(mesh.triangles, before.triangles);
}

// What is left of the faces has longer triangles.
TEST(Coarsen, CornersAndEdgesOfACubeStay) {
  Mesh cube;
  constexpr int n = 8;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          std::array<std::uint32_t, 4> corner{};
          for (std::size_t k = 0; k < 4; ++k) {
            Vec3 p{};
            p[static_cast<std::size_t>(axis)] = side;
            p[static_cast<std::size_t>((axis + 1) % 3)] = i + (k == 1 || k == 2 ? 1 : 0);
            p[static_cast<std::size_t>((axis + 2) % 3)] = j + (k >= 2 ? 1 : 0);
            const auto found = std::find(cube.vertices.begin(), cube.vertices.end(), p);
            corner[k] = static_cast<std::uint32_t>(found - cube.vertices.begin());
            if (found == cube.vertices.end()) cube.vertices.push_back(p);
          }
          if (side == 0) std::swap(corner[1], corner[3]);
          cube.triangles.push_back({corner[0], corner[1], corner[2]});
          cube.triangles.push_back({corner[0], corner[2], corner[3]});
        }
      }
    }
  }
  const std::size_t before = cube.triangles.size();
  mesh::coarsen(cube, {{0, 0, 0}}, {2.5});
  const Topology t = topology(cube);
  EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U);
  EXPECT_EQ(t.genus, 0);
  EXPECT_LT(cube.triangles.size(), before / 2);
  EXPECT_NEAR(t.volume, n * n * n, 1e-9);
}

TEST(Quadric, IsTheWeightedSumOfSquaredDistancesFromItsPlanes) {
  mesh::Quadric quadric, other;
  quadric.add_plane({0.6, 0.8, 0}, 0.25, 2);
  other.add_plane({0, -0.28, 0.96}, -1, 3);
  quadric.add(other);
  const Vec3 p{0.5, -2, 4};
  const double first = 0.6 * p[0] + 0.8 * p[1] + 0.25, second = -0.28 * p[1] + 0.96 * p[2] - 1;
  EXPECT_NEAR(quadric.squared_distances(p), 2 * first * first + 3 * second * second, 1e-12);
  EXPECT_EQ(quadric.weight, 5);
}

}  // namespace
