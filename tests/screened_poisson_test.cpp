#include "mesh/screened_poisson.h"

#include <g3r/error.h>
#include <g3r/metrics.h>
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "mesh_shapes.h"

namespace g3r {
namespace {

#ifdef G3R_WITH_OPEN3D

// The meshes at these depths are this close to the true volume.
constexpr double kVolumeTolerance = 0.01;
constexpr int kDepth = 6;

Samples sphere_samples() { return sample_mesh(shapes::sphere(1, 200), 5000, 1); }

Mesh reconstructed(const Samples& samples, int depth = kDepth) { return screened_poisson(samples.points, samples.normals, depth); }

TEST(ScreenedPoisson, SphereIsClosedManifoldOutwardAndOfTheRightVolume) {
  const Mesh mesh = reconstructed(sphere_samples());
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_EQ(check.components, 1u);
  EXPECT_EQ(check.genus, 0);
  EXPECT_EQ(check.vertices, mesh.vertices.size());
  const double volume = 4 * shapes::kPi / 3;
  EXPECT_NEAR(check.volume, volume, kVolumeTolerance * volume);
}

TEST(ScreenedPoisson, TorusHasGenusOneAndTheRightVolume) {
  const MeshCheck check = check_mesh(reconstructed(sample_mesh(shapes::torus(1, 0.4, 200, 100), 10000, 2)));
  EXPECT_TRUE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_EQ(check.components, 1u);
  EXPECT_EQ(check.genus, 1);
  const double volume = 2 * shapes::kPi * shapes::kPi * 0.4 * 0.4;
  EXPECT_NEAR(check.volume, volume, kVolumeTolerance * volume);
}

TEST(ScreenedPoisson, HollowBallKeepsBothItsSurfaces) {
  const Mesh hollow = shapes::united(shapes::sphere(1, 120), shapes::inverted(shapes::sphere(0.5, 120)));
  const MeshCheck check = check_mesh(reconstructed(sample_mesh(hollow, 10000, 3)));
  EXPECT_EQ(check.components, 2u);
  const double volume = 4 * shapes::kPi / 3 * (1 - 0.125);
  EXPECT_NEAR(check.volume, volume, kVolumeTolerance * volume);
}

TEST(ScreenedPoisson, TwoRunsGiveTheSameBytes) {
  const Samples samples = sphere_samples();
  const Mesh first = reconstructed(samples), second = reconstructed(samples);
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST(ScreenedPoisson, ConcurrentCallsGiveTheSameBytes) {
  const Samples samples = sphere_samples();
  Mesh first, second;
  std::thread other([&] { first = reconstructed(samples); });
  second = reconstructed(samples);
  other.join();
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST(ScreenedPoisson, LengthOfTheNormalsHasNoInfluence) {
  Samples samples = sphere_samples();
  const Mesh first = reconstructed(samples);
  for (std::size_t i = 0; i < samples.normals.size(); ++i) {
    for (double& x : samples.normals[i]) x = std::ldexp(x, static_cast<int>(i % 600) - 300);
  }
  EXPECT_EQ(first.triangles.size(), reconstructed(samples).triangles.size());
}

TEST(ScreenedPoisson, PowerOfTwoScalesGiveTheSameTriangles) {
  Samples samples = sphere_samples();
  const Mesh first = reconstructed(samples);
  for (Vec3& p : samples.points) p = {p[0] * 0x1p-100, p[1] * 0x1p-100, p[2] * 0x1p-100};
  const Mesh second = reconstructed(samples);
  EXPECT_EQ(first.triangles, second.triangles);
  EXPECT_EQ(first.vertices[0][0] * 0x1p-100, second.vertices[0][0]);
}

TEST(ScreenedPoisson, LargeCoordinatesAndOddUnitsGiveTheSameSurface) {
  const Samples samples = sphere_samples();
  const Mesh at_origin = reconstructed(samples);
  const double cell = 1.1 * 2 / (1 << kDepth);
  for (const auto& [offset, scale] : {std::pair<Vec3, double>{{5e6, 4e5, 100}, 1}, {{0, 0, 0}, 1e-30}, {{0, 0, 0}, 1e30}}) {
    Samples there = samples;
    for (Vec3& p : there.points) p = {p[0] * scale + offset[0], p[1] * scale + offset[1], p[2] * scale + offset[2]};
    Mesh back = reconstructed(there);
    for (Vec3& p : back.vertices) p = {(p[0] - offset[0]) / scale, (p[1] - offset[1]) / scale, (p[2] - offset[2]) / scale};
    EXPECT_LT(score_mesh(back, at_origin, {5000}).hausdorff, 0.01 * cell);  // the solver stops at a residual of 1e-3
  }
}

TEST(ScreenedPoisson, NothingIsPrinted) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  (void)reconstructed(sphere_samples());
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ScreenedPoisson, FewPointsGiveAMeshOrAnError) {
  const Samples samples = sphere_samples();
  for (const std::size_t n : {4u, 5u, 8u, 20u}) {
    const std::vector<Vec3> points(samples.points.begin(), samples.points.begin() + static_cast<std::ptrdiff_t>(n));
    const std::vector<Vec3> normals(samples.normals.begin(), samples.normals.begin() + static_cast<std::ptrdiff_t>(n));
    try {
      EXPECT_FALSE(screened_poisson(points, normals, 5).triangles.empty());
    } catch (const InvalidInput&) {
    }
  }
}

TEST(ScreenedPoisson, UnusableInputIsRefused) {
  const Samples good = sphere_samples();
  EXPECT_THROW((void)screened_poisson({}, {}, kDepth), InvalidInput);
  EXPECT_THROW((void)screened_poisson({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}, kDepth), InvalidInput);
  EXPECT_THROW((void)screened_poisson(good.points, {}, kDepth), InvalidInput);
  EXPECT_THROW((void)reconstructed(good, 3), InvalidInput);
  EXPECT_THROW((void)reconstructed(good, 13), InvalidInput);
  const std::vector<Vec3> one_place(100, {1, 2, 3});
  EXPECT_THROW((void)screened_poisson(one_place, std::vector<Vec3>(100, {0, 0, 1}), kDepth), InvalidInput);
  Samples bad = good;
  bad.points[7][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)reconstructed(bad), InvalidInput);
  bad = good;
  bad.normals[7][1] = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)reconstructed(bad), InvalidInput);
  bad = good;
  bad.normals[7] = {0, 0, 0};
  EXPECT_THROW((void)reconstructed(bad), InvalidInput);
}

#else

TEST(ScreenedPoisson, IsUnavailableWithoutOpen3D) { EXPECT_THROW((void)screened_poisson({}, {}, 8), Unavailable); }

#endif

TEST(AutomaticDepth, CellsAreAboutAsWideAsThePointsAreApart) {
  EXPECT_EQ(automatic_depth(1.1 / 64, 1), 6);
  EXPECT_EQ(automatic_depth(1.1 / 256 * 1.2, 1), 8);
  EXPECT_EQ(automatic_depth(1e-3 * 1.1 / 256, 1e-3), 8);
}

TEST(AutomaticDepth, StaysBetweenFourAndTen) {
  EXPECT_EQ(automatic_depth(1, 1), 4);
  EXPECT_EQ(automatic_depth(1e-9, 1), 10);
  EXPECT_EQ(automatic_depth(0, 1), 10);
  EXPECT_EQ(automatic_depth(std::numeric_limits<double>::quiet_NaN(), 1), 4);
}

}  // namespace
}  // namespace g3r
