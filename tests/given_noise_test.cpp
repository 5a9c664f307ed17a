// The size of the noise that the caller gives stands for the estimate, in normals and meshes.
#include <g3r/g3r.h>

#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace g3r {
namespace {

using shapes::Surface;

TEST(Noise, TheGivenOneStandsForTheEstimate) {
  Surface sphere = shapes::sphere(3000, 1);
  shapes::scatter(sphere, 0.03);
  const Orientation automatic = orient(sphere.points);
  ASSERT_GT(automatic.stats.noise, 0);
  Options options;
  options.noise = {Length::Unit::kInput, automatic.stats.noise};
  EXPECT_LT(shapes::angle_error(orient(sphere.points, options).normals, automatic.normals), 1e-6);
  options.noise = {Length::Unit::kSpacing, 0.2};
  EXPECT_NEAR(orient(sphere.points, options).stats.noise, 0.2 * automatic.stats.spacing, 1e-12);
  options.noise = {Length::Unit::kPercent, 1};
  EXPECT_NEAR(orient(sphere.points, options).stats.noise, 0.01 * std::sqrt(12.0), 2e-3);
  options.noise = {Length::Unit::kSpacing, 0};
  const Orientation clean = orient(sphere.points, options);
  EXPECT_EQ(clean.stats.noise, 0);
  EXPECT_GT(shapes::angle_error(clean.normals, sphere.normals), 1.2 * shapes::angle_error(automatic.normals, sphere.normals));
}

// Mean distance of the vertices from the unit sphere.
double roughness(const Mesh& mesh) {
  double sum = 0;
  for (const Vec3& v : mesh.vertices) sum += std::abs(std::hypot(v[0], v[1], v[2]) - 1);
  return sum / static_cast<double>(mesh.vertices.size());
}

// Clean points stay where they are, noisy ones are moved onto the surface that they scatter about.
TEST(Noise, TheGivenOneReachesTheMesher) {
  Surface sphere = shapes::sphere(3000, 1);
  shapes::scatter(sphere, 0.03);
  MeshOptions mesh;
  const double estimated = roughness(mesh_oriented(sphere.points, sphere.normals));
  mesh.noise = {Length::Unit::kInput, 0.03};
  EXPECT_NEAR(roughness(mesh_oriented(sphere.points, sphere.normals, mesh)), estimated, 0.1 * estimated);
  mesh.noise.value = 0;
  EXPECT_GT(roughness(mesh_oriented(sphere.points, sphere.normals, mesh)), 2 * estimated);
  mesh.noise.value = -1;
  EXPECT_THROW((void)mesh_oriented(sphere.points, sphere.normals, mesh), InvalidInput);
  Options options;
  options.noise = {Length::Unit::kSpacing, 0};
  const Reconstruction clean = reconstruct(sphere.points, options);
  mesh.noise = options.noise;
  const double same = roughness(mesh_oriented(sphere.points, clean.orientation.normals, mesh));
  EXPECT_NEAR(roughness(clean.mesh), same, 0.01 * same);  // with its own estimate a quarter more
}

// However large: what comes out are unit vectors.
TEST(Noise, AnySizeIsTaken) {
  const Surface sphere = shapes::sphere(2000);
  for (const double spacings : {1e-12, 3.0, 1e3, 1e9}) {
    Options options;
    options.noise = {Length::Unit::kSpacing, spacings};
    for (const Vec3& n : orient(sphere.points, options).normals) ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-9) << spacings;
  }
}

}  // namespace
}  // namespace g3r
