// Meshes stay manifold in programs that weld vertices at one place: by construction, and after every format.
#include "mesh/separate_vertices.h"

#include <g3r/g3r.h>
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <random>
#include <string>

#include "base/suits_float.h"
#include "mesh_topology.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

// As a reader does that welds: vertices at one place become one.
Mesh welded(const Mesh& mesh) {
  Mesh out;
  std::map<Vec3, std::uint32_t> number;
  for (const auto& t : mesh.triangles) {
    auto& added = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, is_new] = number.try_emplace(mesh.vertices[t[k]], static_cast<std::uint32_t>(out.vertices.size()));
      if (is_new) out.vertices.push_back(mesh.vertices[t[k]]);
      added[k] = found->second;
    }
  }
  return out;
}

Mesh rounded(Mesh mesh) {
  for (Vec3& v : mesh.vertices) {
    for (double& c : v) c = static_cast<double>(static_cast<float>(c));
  }
  return mesh;
}

void expect_manifold(const Mesh& mesh, const std::string& where) {
  const Topology t = topology(mesh);
  EXPECT_EQ(t.bad_edges, 0U) << where;
  EXPECT_EQ(t.bad_vertices, 0U) << where;
}

// Plates of half a spacing, with gaps of half a spacing between them: patches that share faces of the octree and touch.
Mesh stack_of_plates() {
  constexpr std::size_t kPoints = 2500;
  constexpr double kStep = 0.03;
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> points, normals;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::size_t layer = i % 4;
    points.push_back({uniform(rng), uniform(rng), kStep * static_cast<double>(layer)});
    normals.push_back({0, 0, layer % 2 == 0 ? -1.0 : 1.0});
  }
  return mesh_oriented(points, normals);
}

// Two tetrahedra that touch in a vertex, which each has for itself, and one that is apart.
Mesh touching_tetrahedra(const Vec3& origin) {
  Mesh mesh;
  const auto add = [&](double side) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : {Vec3{0, 0, 0}, Vec3{side, 0, 0}, Vec3{0, side, 0}, Vec3{0, 0, side}}) {
      mesh.vertices.push_back({origin[0] + v[0], origin[1] + v[1], origin[2] + v[2]});
    }
    const bool turned = side < 0;
    for (auto t : {std::array<std::uint32_t, 3>{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
      if (turned) std::swap(t[1], t[2]);
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  };
  add(1);
  add(-0.5);
  return mesh;
}

TEST(SeparateVertices, MeshesStayManifoldInEveryFormat) {
  const Mesh mesh = stack_of_plates();
  ASSERT_GT(mesh.triangles.size(), 1000U);
  expect_manifold(welded(mesh), "as it is");
  expect_manifold(welded(rounded(mesh)), "float");
  const auto folder = std::filesystem::path(::testing::TempDir()) / "separate_vertices";
  std::filesystem::create_directories(folder);
  for (const char* name : {"a.ply", "a.stl", "a.obj", "a.off", "a.glb"}) {
    for (const bool ascii : {false, true}) {
      const std::string path = (folder / name).string();
      write_mesh(path, mesh, {.ascii = ascii});
      expect_manifold(welded(read_mesh(path)), name);
    }
  }
  std::filesystem::remove_all(folder);
}

TEST(SeparateVertices, VerticesAtOnePlacePartByAFewStepsOfFloat) {
  Mesh mesh = touching_tetrahedra({0.3, 0.4, 0.5});
  const Mesh before = mesh;
  EXPECT_EQ(topology(welded(mesh)).bad_vertices, 1U);
  EXPECT_EQ(mesh::separate_vertices(mesh), 1U);
  expect_manifold(welded(mesh), "apart");
  expect_manifold(welded(rounded(mesh)), "apart in float");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(mesh.vertices[v][a], before.vertices[v][a], 1e-6);
  }
  EXPECT_EQ(mesh::separate_vertices(mesh), 0U);
}

// Only rounding brings these together.
TEST(SeparateVertices, VerticesThatFloatMergesPartToo) {
  Mesh mesh = touching_tetrahedra({0.3, 0.4, 0.5});
  for (std::size_t v = 4; v < 8; ++v) mesh.vertices[v][0] -= 1e-10;
  EXPECT_EQ(mesh::separate_vertices(mesh), 1U);
  expect_manifold(welded(rounded(mesh)), "apart in float");
}

// There float about the origin cannot distinguish the vertices of anything; formats with float about the centre still must.
TEST(SeparateVertices, FarFromTheOriginOnlyTheCentreCounts) {
  const Vec3 far{500000, 5000000, 100};
  Mesh mesh = touching_tetrahedra(far);
  EXPECT_FALSE(suits_float({far, {500001, 5000001, 101}}));
  EXPECT_TRUE(suits_float({{-1, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(mesh::separate_vertices(mesh), 1U);
  Mesh centred = mesh;
  for (Vec3& v : centred.vertices) {
    for (std::size_t a = 0; a < 3; ++a) v[a] -= far[a] + 0.25;
  }
  expect_manifold(welded(rounded(centred)), "about the centre");
}

}  // namespace
