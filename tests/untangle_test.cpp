// Triangles that cross are pulled apart, and nothing else moves.
#include "mesh/untangle.h"

#include <g3r/mesh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/vector.h"
#include "mesh/half_edges.h"
#include "mesh_shapes.h"

namespace g3r {
namespace {

TEST(Untangle, LeavesCleanMeshesAlone) {
  const Mesh before = shapes::torus(1, 0.4, 60, 40);
  Mesh mesh = before;
  EXPECT_EQ(mesh::untangle(mesh), 0U);
  EXPECT_EQ(mesh.vertices, before.vertices);
}

// Pushes vertices past their neighbours, as placement beyond a crease does, and returns which.
std::vector<std::uint32_t> tangle(const Mesh& clean, Mesh& mesh) {
  std::mt19937_64 rng(3);
  std::vector<std::uint32_t> pushed;
  for (int i = 0; i < 60; ++i) {
    const std::array<std::uint32_t, 3>& t = mesh.triangles[rng() % mesh.triangles.size()];
    const Vec3 from = clean.vertices[t[0]], to = clean.vertices[t[1]];
    for (std::size_t a = 0; a < 3; ++a) mesh.vertices[t[0]][a] = from[a] + 2.5 * (to[a] - from[a]) + (a == 2 ? 0.01 : 0);
    pushed.push_back(t[0]);
  }
  return pushed;
}

TEST(Untangle, UnfoldsWhatCrossesAndKeepsTheRest) {
  const Mesh clean = shapes::torus(1, 0.4, 120, 80);
  Mesh mesh = clean;
  const std::vector<std::uint32_t> pushed = tangle(clean, mesh);
  ASSERT_GT(count_self_intersections(mesh), 60U);
  const Mesh tangled = mesh;
  EXPECT_EQ(mesh::untangle(mesh), 0U);
  EXPECT_EQ(count_self_intersections(mesh), 0U);
  EXPECT_EQ(mesh.triangles, clean.triangles);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) moved += mesh.vertices[v] != tangled.vertices[v] ? 1 : 0;
  EXPECT_GE(moved, pushed.size() / 2);
  EXPECT_LT(moved, mesh.vertices.size() / 4);
}

// The least cosine between the normals of two triangles at an edge.
double sharpest(const Mesh& mesh) {
  const auto normal = [&](std::size_t f) {
    const auto& t = mesh.triangles[f];
    return vector::normalised(vector::cross(vector::subtract(mesh.vertices[t[1]], mesh.vertices[t[0]]),
                                            vector::subtract(mesh.vertices[t[2]], mesh.vertices[t[0]])));
  };
  double least = 1;
  for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t) {
    least = std::min(least, vector::dot(normal(half_edges[0].corner / 3), normal(half_edges[1].corner / 3)));
  });
  return least;
}

TEST(Untangle, ThornsGoAndTheRestStays) {
  const Mesh clean = shapes::torus(1, 0.4, 60, 40);
  Mesh mesh = clean;
  constexpr std::uint32_t kApart = 97;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); v += kApart) {
    for (double& c : mesh.vertices[v]) c *= 1.3;
  }
  ASSERT_LT(sharpest(mesh), -0.5);
  const Mesh thorny = mesh;
  mesh::soften_thorns(mesh, count_self_intersections(mesh));
  EXPECT_GT(sharpest(mesh), -0.5);
  EXPECT_EQ(mesh.triangles, clean.triangles);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) moved += mesh.vertices[v] != thorny.vertices[v] ? 1 : 0;
  EXPECT_LT(moved, mesh.vertices.size() / 8);
  mesh = clean;
  mesh::soften_thorns(mesh, 0);
  EXPECT_EQ(mesh.vertices, clean.vertices);
}

TEST(Untangle, SofteningMakesNoCrossings) {
  const Mesh clean = shapes::torus(1, 0.4, 120, 80);
  Mesh mesh = clean;
  (void)tangle(clean, mesh);
  const std::size_t before = count_self_intersections(mesh);
  mesh::soften_thorns(mesh, before);
  EXPECT_LE(count_self_intersections(mesh), before);
}

// Two tori that intersect, which no softening touches, beside one with thorns: it ends, and moves nothing.
TEST(Untangle, SofteningEndsWhereCrossingsStay) {
  const Mesh clean = shapes::torus(1, 0.4, 60, 40);
  Mesh mesh = clean;
  for (double& c : mesh.vertices[97]) c *= 1.3;
  for (const double shift : {5.0, 5.1}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : clean.vertices) mesh.vertices.push_back({v[0] + shift, v[1], v[2]});
    for (const auto& t : clean.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const std::vector<Vec3> before = mesh.vertices;
  ASSERT_GT(count_self_intersections(mesh), 0U);
  ASSERT_LT(sharpest(mesh), -0.5);
  mesh::soften_thorns(mesh, 0);
  EXPECT_EQ(mesh.vertices, before);
}

TEST(Untangle, FixedVerticesStay) {
  const Mesh clean = shapes::torus(1, 0.4, 120, 80);
  Mesh mesh = clean;
  (void)tangle(clean, mesh);
  const Mesh tangled = mesh;
  const std::size_t before = count_self_intersections(mesh);
  std::vector<std::uint8_t> fixed;
  for (const Vec3& v : mesh.vertices) fixed.push_back(v[0] < 0 ? 1 : 0);
  const std::size_t left = mesh::untangle(mesh, nullptr, fixed);
  EXPECT_GT(left, 0U);
  EXPECT_LT(left, before);
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    EXPECT_TRUE(fixed[v] == 0 || mesh.vertices[v] == tangled.vertices[v]) << v;
  }
}

// Two spheres through each other cannot be pulled apart; the mesh must come out no worse, and whole.
TEST(Untangle, DoesNotMakeItWorse) {
  Mesh mesh = shapes::united(shapes::sphere(1, 24), shapes::moved(shapes::sphere(1, 24), {0.9, 0.05, 0.02}));
  const std::size_t before = count_self_intersections(mesh);
  const auto triangles = mesh.triangles;
  EXPECT_LE(mesh::untangle(mesh), before);
  EXPECT_EQ(mesh.triangles, triangles);
  EXPECT_LE(count_self_intersections(mesh), before);
}

}  // namespace
}  // namespace g3r
