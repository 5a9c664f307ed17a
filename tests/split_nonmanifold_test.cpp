#include "mesh/split_nonmanifold.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <set>

#include "mesh_shapes.h"
#include "metrics/random.h"

namespace g3r {
namespace {

constexpr double kRoundingOfMeasures = 1e-12;

/// The surface of unit cells of a grid, with vertices shared by position: touches itself in edges and vertices.
Mesh cells(const std::set<std::array<int, 3>>& solid) {
  Mesh mesh;
  std::map<Vec3, std::uint32_t> index;
  const Mesh cube = shapes::cube();
  for (const auto& cell : solid) {
    for (std::size_t f = 0; f < 12; ++f) {
      // Two triangles per face: the neighbour behind the face decides for both.
      std::array<int, 3> neighbour = cell;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& t = cube.triangles[f];
        if (cube.vertices[t[0]][k] == cube.vertices[t[1]][k] && cube.vertices[t[1]][k] == cube.vertices[t[2]][k]) {
          neighbour[k] += cube.vertices[t[0]][k] > 0.5 ? 1 : -1;
        }
      }
      if (solid.count(neighbour) > 0) continue;
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 p = cube.vertices[cube.triangles[f][k]];
        for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += cell[axis];
        const auto [at, is_new] = index.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (is_new) mesh.vertices.push_back(p);
        triangle[k] = at->second;
      }
      mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

void expect_made_manifold(const Mesh& mesh) {
  const MeshCheck before = check_mesh(mesh);
  const MeshCheck after = check_mesh(split_nonmanifold(mesh));
  EXPECT_TRUE(after.closed);
  EXPECT_TRUE(after.manifold);
  EXPECT_NEAR(after.volume, before.volume, kRoundingOfMeasures * before.area);
  EXPECT_NEAR(after.area, before.area, kRoundingOfMeasures * before.area);
}

TEST(SplitNonmanifold, ManifoldMeshIsReturnedUnchanged) {
  const Mesh torus = shapes::torus(1, 0.4, 12, 8);
  const Mesh split = split_nonmanifold(torus);
  EXPECT_EQ(split.vertices, torus.vertices);
  EXPECT_EQ(split.triangles, torus.triangles);
}

TEST(SplitNonmanifold, CubesThatTouchInAnEdgeComeApart) {
  const Mesh mesh = cells({{0, 0, 0}, {1, 1, 0}});
  EXPECT_FALSE(check_mesh(mesh).manifold);
  expect_made_manifold(mesh);
  EXPECT_EQ(check_mesh(split_nonmanifold(mesh)).components, 2u);
}

TEST(SplitNonmanifold, CubesThatTouchInAVertexComeApart) {
  const Mesh mesh = cells({{0, 0, 0}, {1, 1, 1}});
  expect_made_manifold(mesh);
  EXPECT_EQ(check_mesh(split_nonmanifold(mesh)).components, 2u);
}

TEST(SplitNonmanifold, RingThatTouchesItselfInAnEdgeStaysInOnePiece) {
  // Both ends of the touching edge are single fans that pass it twice: copies of its ends would not do.
  const Mesh mesh = cells({{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 0, 1}, {1, 1, 1}});
  EXPECT_FALSE(check_mesh(mesh).manifold);
  expect_made_manifold(mesh);
  EXPECT_EQ(check_mesh(split_nonmanifold(mesh)).components, 1u);
}

TEST(SplitNonmanifold, RandomCellsBecomeClosedAndManifold) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    std::set<std::array<int, 3>> solid{{0, 0, 0}};
    for (int i = 0; i < 64; ++i) {
      if (random.uniform() < 0.4) solid.insert({i % 4, i / 4 % 4, i / 16});
    }
    expect_made_manifold(cells(solid));
  }
}

TEST(SplitNonmanifold, RandomTrianglesKeepTheirAreaAndGainNoBoundary) {
  Random random(6);
  for (int trial = 0; trial < 300; ++trial) {
    Mesh mesh;
    for (int i = 0; i < 7; ++i) mesh.vertices.push_back({random.uniform(), random.uniform(), random.uniform()});
    std::set<std::set<std::uint32_t>> used;
    for (int i = 0; i < 25; ++i) {
      const auto vertex = [&] { return static_cast<std::uint32_t>(random.bits() % 7); };
      const std::array<std::uint32_t, 3> t = {vertex(), vertex(), vertex()};
      // Each set of three vertices once, so that no two fold onto each other.
      if (const std::set<std::uint32_t> set(t.begin(), t.end()); set.size() == 3 && used.insert(set).second) mesh.triangles.push_back(t);
    }
    const MeshCheck before = check_mesh(mesh), after = check_mesh(split_nonmanifold(mesh));
    EXPECT_NEAR(after.area, before.area, kRoundingOfMeasures * before.area);
    EXPECT_EQ(after.boundary_edges, before.boundary_edges);
    EXPECT_LE(after.nonmanifold_edges, before.nonmanifold_edges);
  }
}

TEST(SplitNonmanifold, TrianglesThatNameAVertexTwiceAreLeftOut) {
  Mesh mesh = shapes::cube();
  mesh.triangles.push_back({1, 1, 5});
  EXPECT_EQ(split_nonmanifold(mesh).triangles, shapes::cube().triangles);
}

TEST(SplitNonmanifold, PairsThatFaceEachOtherOnTheSameVerticesAreLeftOut) {
  Mesh mesh = shapes::cube();
  mesh.triangles.push_back({0, 5, 6});
  mesh.triangles.push_back({6, 5, 0});
  mesh.triangles.push_back({4, 5, 7});  // twice there, once inverted: one stays
  mesh.triangles.push_back({5, 4, 7});
  const MeshCheck check = check_mesh(split_nonmanifold(mesh));
  EXPECT_EQ(check.triangles, 12u);
  EXPECT_TRUE(check.closed && check.manifold);
}

TEST(SplitNonmanifold, BoundariesStay) {
  const Mesh mesh = shapes::square(1, 0, 3);
  EXPECT_EQ(split_nonmanifold(mesh).triangles, mesh.triangles);
  Mesh fins;  // three triangles at one edge
  fins.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  fins.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  EXPECT_EQ(split_nonmanifold(fins).triangles, fins.triangles);
}

TEST(SplitNonmanifold, CopiesCarryColourAndConfidence) {
  Mesh mesh = cells({{0, 0, 0}, {1, 1, 0}});
  mesh.colors.assign(mesh.vertices.size(), {10, 20, 30});
  mesh.confidence.assign(mesh.vertices.size(), 0.5f);
  const Mesh split = split_nonmanifold(mesh);
  EXPECT_GT(split.vertices.size(), mesh.vertices.size());
  ASSERT_EQ(split.colors.size(), split.vertices.size());
  ASSERT_EQ(split.confidence.size(), split.vertices.size());
  EXPECT_EQ(split.colors.back(), (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_EQ(split.confidence.back(), 0.5f);
}

}  // namespace
}  // namespace g3r
