#include "mesh/edge_collapse.h"

#include "mesh/mesh_parts.h"

#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// A square grid in the plane, two triangles a square.
Mesh grid(std::uint32_t side) {
  Mesh mesh;
  for (std::uint32_t y = 0; y <= side; ++y) {
    for (std::uint32_t x = 0; x <= side; ++x) mesh.vertices.push_back({double(x), double(y), 0});
  }
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + 1, c = b + side + 1, d = a + side + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

TEST(EdgeCollapse, TakesTheTrianglesOfTheEdgeAlone) {
  Mesh mesh = grid(4);
  mesh::EdgeCollapse edges(mesh);
  const std::size_t before = edges.count();
  EXPECT_TRUE(edges.collapse(12, 13));  // in the middle
  EXPECT_EQ(edges.count(), before - 2);
  EXPECT_FALSE(edges.is_used(12));
  EXPECT_TRUE(std::binary_search(edges.neighbours().begin(), edges.neighbours().end(), 13U));
  EXPECT_TRUE(edges.collapse(1, 2));  // on the boundary
  EXPECT_EQ(edges.count(), before - 3);
  const auto left = static_cast<std::size_t>(std::count(edges.is_left().begin(), edges.is_left().end(), std::uint8_t{1}));
  EXPECT_EQ(left, edges.count());
}

// An edge from boundary to boundary through the inside would pinch the mesh, and one of three common neighbours would fold it.
TEST(EdgeCollapse, RefusesWhatChangesTheTopology) {
  Mesh strip = grid(1);
  mesh::EdgeCollapse pinched(strip);
  EXPECT_FALSE(pinched.collapse(0, 3));  // the diagonal: both ends on the boundary
  Mesh tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  mesh::EdgeCollapse closed(tetrahedron);
  for (std::uint32_t a = 0; a < 4; ++a) {
    for (std::uint32_t b = 0; b < 4; ++b) EXPECT_TRUE(a == b || !closed.collapse(a, b));
  }
  EXPECT_EQ(closed.count(), 4U);
}

// Whatever edges are asked for, in whatever order.
TEST(EdgeCollapse, AnyCollapsesKeepTheEulerCharacteristic) {
  const shapes::Surface s = shapes::torus(800, 0.6, 0.25, 2);
  const Mesh whole = mesh_oriented(PointsView(s.points), PointsView(s.normals));
  const MeshCheck before = check_mesh(whole);
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Mesh mesh = whole;
    mesh::EdgeCollapse edges(mesh);
    shapes::Random random(seed);
    std::vector<std::uint32_t> neighbours;
    for (std::size_t k = 0; k < 20 * whole.vertices.size(); ++k) {
      const auto v = static_cast<std::uint32_t>(random.uniform(0, 1) * static_cast<double>(whole.vertices.size()));
      if (!edges.is_used(v)) continue;
      edges.find_neighbours(v, neighbours);
      (void)edges.collapse(v, neighbours[k % neighbours.size()]);
    }
    EXPECT_LT(edges.count(), whole.triangles.size() / 4);
    mesh::remove_triangles(mesh, edges.is_left());
    const MeshCheck after = check_mesh(mesh);
    EXPECT_TRUE(after.closed && after.manifold) << seed;
    EXPECT_EQ(after.genus, before.genus) << seed;
    EXPECT_EQ(after.components, before.components) << seed;
  }
}

}  // namespace
}  // namespace g3r
