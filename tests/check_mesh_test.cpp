#include <g3r/error.h>
#include <g3r/mesh.h>
#include <gtest/gtest.h>

#include <limits>

#include "mesh_shapes.h"

namespace g3r {
namespace {

// Rounding of sums over a few thousand triangles.
constexpr double kRounding = 1e-12;

void expect_closed_manifold(const MeshCheck& check) {
  EXPECT_TRUE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_EQ(check.boundary_edges, 0u);
  EXPECT_EQ(check.nonmanifold_edges, 0u);
  EXPECT_EQ(check.nonmanifold_vertices, 0u);
}

TEST(CheckMesh, TetrahedronIsClosedWithItsVolumeAndArea) {
  const MeshCheck check = check_mesh(shapes::tetrahedron());
  expect_closed_manifold(check);
  EXPECT_EQ(check.vertices, 4u);
  EXPECT_EQ(check.triangles, 4u);
  EXPECT_EQ(check.components, 1u);
  EXPECT_EQ(check.genus, 0);
  EXPECT_NEAR(check.volume, 1.0 / 6, kRounding);
  EXPECT_NEAR(check.area, 1.5 + std::sqrt(3.0) / 2, kRounding);
}

TEST(CheckMesh, CubeHasVolumeOneAndAreaSix) {
  const MeshCheck check = check_mesh(shapes::cube());
  expect_closed_manifold(check);
  EXPECT_NEAR(check.volume, 1, kRounding);
  EXPECT_NEAR(check.area, 6, kRounding);
}

TEST(CheckMesh, InvertedMeshHasNegativeVolume) {
  const MeshCheck check = check_mesh(shapes::inverted(shapes::cube()));
  expect_closed_manifold(check);
  EXPECT_NEAR(check.volume, -1, kRounding);
}

TEST(CheckMesh, TorusHasGenusOne) {
  const MeshCheck check = check_mesh(shapes::torus(1, 0.4, 60, 40));
  expect_closed_manifold(check);
  EXPECT_EQ(check.components, 1u);
  EXPECT_EQ(check.genus, 1);
}

TEST(CheckMesh, GenusAddsUpOverComponents) {
  const Mesh torus = shapes::torus(1, 0.4, 12, 8);
  const MeshCheck check = check_mesh(shapes::united(shapes::united(torus, shapes::moved(torus, {5, 0, 0})), shapes::cube()));
  expect_closed_manifold(check);
  EXPECT_EQ(check.components, 3u);
  EXPECT_EQ(check.genus, 2);
}

TEST(CheckMesh, VolumeKeepsItsDigitsFarFromTheOrigin) {
  const MeshCheck check = check_mesh(shapes::moved(shapes::cube(), {5e6, -3e6, 100}));
  EXPECT_NEAR(check.volume, 1, kRounding);
}

TEST(CheckMesh, PatchHasItsRimAsBoundary) {
  const MeshCheck check = check_mesh(shapes::square(1, 0, 5));
  EXPECT_FALSE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_EQ(check.boundary_edges, 20u);
  EXPECT_EQ(check.components, 1u);
}

TEST(CheckMesh, BowTieVertexJoinsNoComponentsAndIsNotManifold) {
  Mesh mesh = shapes::united(shapes::tetrahedron(), shapes::moved(shapes::tetrahedron(), {1, 0, 0}));
  for (auto& t : mesh.triangles) {
    for (auto& v : t) v = v == 4 ? 1 : v;  // vertex 4 lies on vertex 1
  }
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.closed);
  EXPECT_FALSE(check.manifold);
  EXPECT_EQ(check.vertices, 7u);
  EXPECT_EQ(check.components, 2u);
  EXPECT_EQ(check.nonmanifold_edges, 0u);
  EXPECT_EQ(check.nonmanifold_vertices, 1u);
}

TEST(CheckMesh, ThreeTrianglesAtAnEdgeAreNotManifold) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const MeshCheck check = check_mesh(mesh);
  EXPECT_FALSE(check.manifold);
  EXPECT_EQ(check.nonmanifold_edges, 1u);
  EXPECT_EQ(check.nonmanifold_vertices, 2u);
  EXPECT_EQ(check.boundary_edges, 6u);
  EXPECT_EQ(check.components, 1u);
}

TEST(CheckMesh, OneFlippedTriangleMakesItsEdgesNotManifold) {
  Mesh mesh = shapes::tetrahedron();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.closed);
  EXPECT_FALSE(check.manifold);
  EXPECT_EQ(check.nonmanifold_edges, 3u);
  EXPECT_EQ(check.nonmanifold_vertices, 0u);
}

TEST(CheckMesh, RepeatedTriangleIsNotManifold) {
  Mesh mesh = shapes::tetrahedron();
  mesh.triangles.push_back(mesh.triangles[0]);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_FALSE(check.closed);
  EXPECT_EQ(check.nonmanifold_edges, 3u);
}

TEST(CheckMesh, TriangleThatNamesAVertexTwiceIsNotManifold) {
  Mesh mesh = shapes::tetrahedron();
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_FALSE(check_mesh(mesh).manifold);
  mesh.triangles = {{2, 2, 2}};
  EXPECT_FALSE(check_mesh(mesh).manifold);
}

TEST(CheckMesh, UnusedVerticesDoNotCount) {
  Mesh mesh = shapes::tetrahedron();
  mesh.vertices.push_back({9, 9, std::numeric_limits<double>::quiet_NaN()});
  const MeshCheck check = check_mesh(mesh);
  expect_closed_manifold(check);
  EXPECT_EQ(check.vertices, 4u);
  EXPECT_EQ(check.genus, 0);
}

TEST(CheckMesh, EmptyMeshIsNotClosed) {
  const MeshCheck check = check_mesh({});
  EXPECT_FALSE(check.closed);
  EXPECT_EQ(check.components, 0u);
  EXPECT_EQ(check.area, 0);
}

TEST(CheckMesh, BadVerticesAreRefused) {
  Mesh mesh = shapes::tetrahedron();
  mesh.triangles.push_back({0, 1, 4});
  EXPECT_THROW((void)check_mesh(mesh), InvalidInput);
  mesh = shapes::tetrahedron();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e60}) {
    mesh.vertices[2][1] = bad;
    EXPECT_THROW((void)check_mesh(mesh), InvalidInput);
  }
}

}  // namespace
}  // namespace g3r
