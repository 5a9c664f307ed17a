// Field mesher: closed, manifold, accurate, sharp, deterministic, cancellable.
#include "mesh/field_mesher.h"

#include "mesh/field_points.h"
#include "mesh/handle_removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cpu/parallel.h"
#include "field_shapes.h"
#include "mesh_topology.h"
#include "sanitized.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

double norm(const Vec3& p) { return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); }

double cube_distance(const Vec3& p, double half) { return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) - half; }

// Root mean square distance of the vertices of a meshed unit sphere of n points.
double sphere_error(std::size_t n) {
  const OrientedSample s = sphere_sample(n, 1, 5);
  const DistanceSampler field([](const Vec3& p) { return norm(p) - 1; }, 1.0 / std::sqrt(static_cast<double>(n)));
  const Mesh mesh = field_mesh(s.points, s.normals, field);
  EXPECT_EQ(topology(mesh).components, 1U);
  EXPECT_EQ(topology(mesh).genus, 0);
  double sum = 0;
  for (const Vec3& v : mesh.vertices) sum += (norm(v) - 1) * (norm(v) - 1);
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

TEST(FieldMesher, SphereConvergesAtThirdOrderInTheSpacing) {
  if (kSanitized) GTEST_SKIP() << "the meshes are like those of the other tests, but larger";
  const double coarse = sphere_error(1000), fine = sphere_error(16000);
  const double order = std::log(coarse / fine) / std::log(4.0);  // the spacing falls by 4
  EXPECT_GT(order, 2.7) << coarse << " -> " << fine;
  EXPECT_LT(fine, 1e-4);
}

TEST(FieldMesher, WindingFieldOfTwoNestedSpheresGivesTwoNestedComponents) {
  constexpr std::size_t kNested = 2000;
  OrientedSample s = sphere_sample(kNested, 1, 1);
  const OrientedSample inner = sphere_sample(kNested / 4, 0.5, 2, -1);
  s.points.insert(s.points.end(), inner.points.begin(), inner.points.end());
  s.normals.insert(s.normals.end(), inner.normals.begin(), inner.normals.end());
  const double area = 4 * M_PI / static_cast<double>(kNested);
  const Mesh mesh = field_mesh(s.points, s.normals, DirectSampler(s, area, 0.55 * std::sqrt(area)));
  const Topology t = topology(mesh);
  EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U);
  EXPECT_EQ(t.components, 2U);
  EXPECT_EQ(t.genus, 0);
  EXPECT_NEAR(t.volume, 4.0 / 3.0 * M_PI * (1 - 0.125), 0.02);
}

// Most points in one place, so that the median spacing says nothing of the others: their leaves are of their own spacing.
TEST(FieldMesher, ATightClusterAmongSparsePointsCostsLittle) {
  OrientedSample s = sphere_sample(300, 1e-5, 4);
  const OrientedSample wide = sphere_sample(200, 1, 5);
  s.points.insert(s.points.end(), wide.points.begin(), wide.points.end());
  s.normals.insert(s.normals.end(), wide.normals.begin(), wide.normals.end());
  const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler([](const Vec3& p) { return norm(p) - 1; }, 0.1));
  EXPECT_EQ(topology(mesh).bad_edges + topology(mesh).bad_vertices, 0U);
  EXPECT_LT(mesh.triangles.size(), 10 * s.points.size());
}

TEST(FieldMesher, SpheresFarApartAreAsFineAsOne) {
  const double far = 3e4;
  OrientedSample s = sphere_sample(1000, 1, 4);
  const std::size_t alone =
      field_mesh(s.points, s.normals, DistanceSampler([](const Vec3& p) { return norm(p) - 1; }, 0.1)).triangles.size();
  for (std::size_t i = 0; i < 1000; ++i) {
    s.points.push_back({s.points[i][0] + far, s.points[i][1], s.points[i][2]});
    s.normals.push_back(s.normals[i]);
  }
  const auto distance = [&](const Vec3& p) { return std::min(norm(p), norm({p[0] - far, p[1], p[2]})) - 1; };
  const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler(distance, 0.1));
  EXPECT_EQ(topology(mesh).components, 2U);
  EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), 2.0 * static_cast<double>(alone), 0.5 * static_cast<double>(alone));
}

TEST(FieldMesher, CubeKeepsItsEdgesAndMostCorners) {
  const OrientedSample s = cube_sample(6000, 0.5, 3);
  const double h = std::sqrt(6.0 / 6000);
  const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler([](const Vec3& p) { return cube_distance(p, 0.5); }, h));
  const Topology t = topology(mesh);
  EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U);
  EXPECT_EQ(t.genus, 0);
  EXPECT_NEAR(t.volume, 1, 1e-3);  // rounding all edges at radius h/2 would lose 12 h^2 / 4 (1 - pi/4) = 6e-4
  double worst = 0, sum = 0;
  for (const Vec3& v : mesh.vertices) {
    worst = std::max(worst, std::abs(cube_distance(v, 0.5)));
    sum += std::abs(cube_distance(v, 0.5));
  }
  EXPECT_LT(worst, 0.5 * h);  // single leaves beside a corner
  EXPECT_LT(sum / static_cast<double>(mesh.vertices.size()), 0.005 * h);
  std::size_t corners = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 c{(k & 1) != 0 ? 0.5 : -0.5, (k & 2) != 0 ? 0.5 : -0.5, (k & 4) != 0 ? 0.5 : -0.5};
    double nearest = 1;
    for (const Vec3& v : mesh.vertices) nearest = std::min(nearest, norm({v[0] - c[0], v[1] - c[1], v[2] - c[2]}));
    if (nearest < 1e-6) ++corners;
  }
  EXPECT_GE(corners, 6U);  // a face may have too few points near a corner
}

// Two cubes and a gap of 1.3 spacings: where its mouth has few points the sides may seem to be one, and all of them go.
TEST(FieldMesher, ANarrowGapIsBridgedNowhere) {
  for (const std::uint64_t seed : {3U, 5U, 7U}) {
    if (kSanitized && seed > 3) continue;
    OrientedSample s = cube_sample(800, 0.5, seed);
    const OrientedSample other = cube_sample(800, 0.5, seed + 100);
    const double h = std::sqrt(6.0 / 800);
    for (std::size_t i = 0; i < other.points.size(); ++i) {
      s.points.push_back({other.points[i][0] + 1 + 1.3 * h, other.points[i][1], other.points[i][2]});
      s.normals.push_back(other.normals[i]);
    }
    const Topology t = topology(field_mesh(s.points, s.normals, DirectSampler(s, h * h, 0.35 * h)));
    EXPECT_EQ(t.components, 2U) << seed;
    EXPECT_EQ(t.genus, 0) << seed;
  }
}

// The cube is centred like its octree, so that edges run between cells, which must not both take them.
TEST(FieldMesher, CreasesBetweenCellsMakeNoTwoVerticesAtOnePlace) {
  for (const std::size_t n : {std::size_t{3000}, std::size_t{6000}, std::size_t{12000}}) {
    if (kSanitized && n > 3000) continue;
    const OrientedSample s = cube_sample(n, 0.5, 3);
    const DistanceSampler field([](const Vec3& p) { return cube_distance(p, 0.5); }, 1.0 / std::sqrt(static_cast<double>(n) / 6));
    std::vector<Vec3> at = field_mesh(s.points, s.normals, field).vertices;
    std::sort(at.begin(), at.end());
    std::size_t close = 0;
    for (std::size_t i = 1; i < at.size(); ++i)
      close += norm({at[i][0] - at[i - 1][0], at[i][1] - at[i - 1][1], at[i][2] - at[i - 1][2]}) < 1e-9 ? 1 : 0;
    EXPECT_EQ(close, 0U) << n;
  }
}

TEST(FieldMesher, SameBytesForAnyNumberOfThreads) {
  const OrientedSample s = sphere_sample(1200, 1, 9);
  const DirectSampler field(s, 4 * M_PI / 1200, 0.05);
  const Mesh one = parallel::with_threads(1, [&] { return field_mesh(s.points, s.normals, field); });
  const Mesh four = parallel::with_threads(4, [&] { return field_mesh(s.points, s.normals, field); });
  EXPECT_EQ(one.vertices, four.vertices);
  EXPECT_EQ(one.triangles, four.triangles);
}

TEST(FieldMesher, RandomNormalsStillGiveAClosedManifold) {
  for (std::uint64_t seed = 0; seed < (kSanitized ? 2 : 8); ++seed) {
    OrientedSample s = sphere_sample(300, 1, seed);
    s.normals = sphere_sample(300, 1, seed + 1000).normals;
    const Mesh mesh = field_mesh(s.points, s.normals, DirectSampler(s, 4 * M_PI / 300, 0.06));
    const Topology t = topology(mesh);
    EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U) << seed;
  }
}

TEST(FieldMesher, ScaleAndShiftOfTheInputMoveTheMeshAlong) {
  const OrientedSample s = sphere_sample(1000, 1, 4);
  const auto moved = [](const Vec3& p) { return Vec3{1024 * p[0] + 1048576, 1024 * p[1] - 2097152, 1024 * p[2] + 524288}; };
  const auto back = [](const Vec3& p) { return Vec3{(p[0] - 1048576) / 1024, (p[1] + 2097152) / 1024, (p[2] - 524288) / 1024}; };
  OrientedSample far = s;
  std::transform(s.points.begin(), s.points.end(), far.points.begin(), moved);
  const Mesh a = field_mesh(s.points, s.normals, DistanceSampler([](const Vec3& p) { return norm(p) - 1; }, 0.1));
  const Mesh b = field_mesh(far.points, far.normals, DistanceSampler([&](const Vec3& p) { return norm(back(p)) - 1; }, 0.1));
  ASSERT_EQ(a.triangles, b.triangles);
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(moved(a.vertices[i])[k], b.vertices[i][k], 1e-6);
  }
}

TEST(FieldMesher, RepeatedPointsAndOutliersDoNoHarm) {
  OrientedSample s = sphere_sample(1000, 1, 6);
  for (int i = 0; i < 30; ++i) {
    s.points.push_back(s.points[0]);
    s.normals.push_back(s.normals[0]);
  }
  s.points.push_back({9, 9, 9});
  s.normals.push_back({0, 0, 1});
  const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler([](const Vec3& p) { return norm(p) - 1; }, 0.1));
  const Topology t = topology(mesh);
  EXPECT_EQ(t.bad_edges + t.bad_vertices, 0U);
  EXPECT_NEAR(t.volume, 4.0 / 3.0 * M_PI, 0.05);
}

TEST(FieldMesher, NoisyPointsAreAveraged) {
  OrientedSample s = sphere_sample(4000, 1, 8);
  const double h = std::sqrt(4 * M_PI / 4000);
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal(0, h);
  for (Vec3& p : s.points) {
    for (double& c : p) c += normal(rng);
  }
  const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler([](const Vec3& p) { return norm(p) - 1; }, 2 * h));
  EXPECT_EQ(topology(mesh).genus, 0);
  double sum = 0;
  for (const Vec3& v : mesh.vertices) sum += std::abs(norm(v) - 1);
  EXPECT_LT(sum / static_cast<double>(mesh.vertices.size()), 0.25 * h);  // a third of the mean deviation of the points, 0.8 h
}

// What fits smooth away needs no leaves: they are half as wide as the fits, and hold as many corners for each handle as without noise.
TEST(FieldMesher, LeavesGrowWithTheFitsUnderNoise) {
  EXPECT_EQ(mesh::cell_under(0), mesh::kFinestCell);
  EXPECT_EQ(mesh::most_per_handle(0, mesh::kFinestCell), mesh::kMostPerHandle);
  EXPECT_EQ(mesh::most_per_handle(0, mesh::kFinestCell / 2), mesh::kMostPerHandle);
  EXPECT_EQ(mesh::most_per_handle(1, mesh::cell_under(1)), 8 * mesh::kMostPerHandle);
  EXPECT_EQ(mesh::most_per_handle(1, mesh::cell_under(1) / 1024), 0x1p33 * mesh::kMostPerHandle);  // more than an integer of 32 bits holds
  const OrientedSample s = sphere_sample(4000, 1, 8);
  const double h = std::sqrt(4 * M_PI / 4000);
  const DistanceSampler field([](const Vec3& p) { return norm(p) - 1; }, 2 * h);
  std::array<double, 2> vertices{};
  for (const double noise : {0.0, 1.0}) {
    MeshOptions options;
    options.noise = {Length::Unit::kInput, noise * h};
    vertices.at(noise > 0 ? 1 : 0) = static_cast<double>(field_mesh(s.points, s.normals, field, options).vertices.size());
  }
  const double wider = mesh::cell_under(1) / mesh::kFinestCell;
  EXPECT_NEAR(vertices[0] / vertices[1], wider * wider, 0.1 * wider * wider);
}

TEST(FieldMesher, FieldWithoutInsideStillGivesAManifold) {
  OrientedSample s = sphere_sample(200, 1, 4);
  const Mesh mesh = field_mesh(s.points, s.normals, DistanceSampler([](const Vec3&) { return 10.0; }, 0.1));
  EXPECT_EQ(topology(mesh).bad_edges, 0U);
}

TEST(FieldMesher, CancelStops) {
  const OrientedSample s = sphere_sample(1000, 1, 4);
  const DistanceSampler field([](const Vec3& p) { return norm(p) - 1; }, 0.1);
  std::atomic<bool> cancel{true};
  Monitor monitor;
  monitor.cancel = &cancel;
  EXPECT_THROW((void)field_mesh(s.points, s.normals, field, {}, monitor), Cancelled);
  Monitor refuse;
  refuse.progress = [](std::string_view, double fraction) { return fraction < 0.5; };
  EXPECT_THROW((void)field_mesh(s.points, s.normals, field, {}, refuse), Cancelled);
}

TEST(FieldMesher, TheOctreeIsHeldAgainstTheMemoryLimit) {
  const OrientedSample s = sphere_sample(1000, 1, 4);
  const DistanceSampler field([](const Vec3& p) { return norm(p) - 1; }, 0.1);
  MeshMemory enough{std::size_t{64} << 20, 0}, less{std::size_t{17} << 20, 0};
  EXPECT_FALSE(field_mesh(s.points, s.normals, field, {}, {}, &enough).triangles.empty());
  EXPECT_LE(enough.needed, enough.limit);
  EXPECT_THROW((void)field_mesh(s.points, s.normals, field, {}, {}, &less), Unavailable);
  EXPECT_EQ(less.needed, enough.needed);
}

TEST(FieldMesher, WhatIsFarFromThePointsIsNotAskedOfTheField) {
  const OrientedSample s = sphere_sample(3000, 1, 4);
  const DistanceSampler field(
      [](const Vec3& p) {
        EXPECT_LT(std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}), 1.12);
        return norm(p) - 1;
      },
      0.1);
  EXPECT_FALSE(field_mesh(s.points, s.normals, field).triangles.empty());
}

TEST(FieldMesher, BadInputIsRefused) {
  const OrientedSample s = sphere_sample(100, 1, 4);
  const DistanceSampler field([](const Vec3& p) { return norm(p) - 1; }, 0.1);
  EXPECT_THROW((void)field_mesh(s.points, {}, field), InvalidInput);
  EXPECT_THROW((void)field_mesh({}, {}, field), InvalidInput);
  EXPECT_THROW((void)field_mesh(std::vector<Vec3>(50, Vec3{1, 2, 3}), std::vector<Vec3>(50, Vec3{0, 0, 1}), field), InvalidInput);
  EXPECT_THROW((void)field_mesh(s.points, std::vector<Vec3>(100, Vec3{0, 0, 0}), field), InvalidInput);
  MeshOptions deep;
  deep.depth = 40;
  EXPECT_THROW((void)field_mesh(s.points, s.normals, field, deep), InvalidInput);
}

}  // namespace
