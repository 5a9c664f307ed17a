#include "view_scenes.h"

#include <g3r/mesh_points.h>

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace g3r {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(MeshPoints, EveryVertexHasTheColorOfItsNearestPoint) {
  Mesh mesh;
  testing::add_cube(mesh, {0, 0, 0}, 1);
  const std::vector<Vec3> points = {{-2, 0, 0}, {kNan, 0, 0}, {2, 0, 0}};
  const auto colors = carry_colors(mesh, points, {{1, 2, 3}, {9, 9, 9}, {4, 5, 6}});
  const auto confidence = carry_confidence(mesh, points, {0.25F, 9, 0.75F});
  for (std::size_t v = 0; v < 8; ++v) {
    const bool right = mesh.vertices[v][0] > 0;
    EXPECT_EQ(colors[v], (right ? std::array<std::uint8_t, 3>{4, 5, 6} : std::array<std::uint8_t, 3>{1, 2, 3}));
    EXPECT_EQ(confidence[v], right ? 0.75F : 0.25F);
  }
}

TEST(MeshPoints, TrimmingKeepsWhatIsNearThePoints) {
  Mesh mesh = testing::torus_mesh(64, 32);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.confidence.push_back(static_cast<float>(mesh.vertices[v][0]));
  std::vector<Vec3> half;
  for (const Vec3& p : testing::torus_points(20000).points) {
    if (p[0] > 0) half.push_back(p);
  }
  const Mesh kept = trim_mesh(mesh, half, 0.1);
  EXPECT_GT(kept.triangles.size(), mesh.triangles.size() / 3);
  EXPECT_LT(kept.triangles.size(), mesh.triangles.size() * 2 / 3);
  for (std::size_t v = 0; v < kept.vertices.size(); ++v) {
    EXPECT_GT(kept.vertices[v][0], -0.1);
    EXPECT_EQ(kept.confidence[v], static_cast<float>(kept.vertices[v][0]));
  }
}

TEST(MeshPoints, TrimmingWithPointsEverywhereChangesNothing) {
  const Mesh mesh = testing::torus_mesh(16, 8);
  const Mesh kept = trim_mesh(mesh, mesh.vertices, 1e-9);
  EXPECT_EQ(kept.vertices, mesh.vertices);
  EXPECT_EQ(kept.triangles, mesh.triangles);
}

TEST(MeshPoints, WrongArgumentsAreRefused) {
  Mesh mesh = testing::torus_mesh(16, 8);
  EXPECT_THROW((void)trim_mesh(mesh, mesh.vertices, 0), InvalidInput);
  EXPECT_THROW((void)trim_mesh(mesh, mesh.vertices, kNan), InvalidInput);
  EXPECT_THROW((void)trim_mesh(mesh, std::vector<Vec3>{{kNan, 0, 0}}, 1), InvalidInput);
  EXPECT_THROW((void)trim_mesh(mesh, std::vector<Vec3>{{100, 0, 0}}, 1), InvalidInput);
  EXPECT_THROW((void)carry_confidence(mesh, mesh.vertices, {1}), InvalidInput);
  mesh.triangles.push_back({0, 1, 9999});
  EXPECT_THROW((void)trim_mesh(mesh, mesh.vertices, 1), InvalidInput);
}

}  // namespace
}  // namespace g3r
