// Normals at creases: sharpened on piecewise smooth shapes, left alone elsewhere.
#include "orient/creases.h"

#include "cloud/neighbours.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

using shapes::Surface;

// Random points on the faces of a cube, their normals, and the means of those within a spacing and a half, as a gradient blurs them.
struct BlurredCube {
  Surface cube;
  std::vector<Vec3> blurred;
  std::vector<double> spacing;
};

BlurredCube blurred_cube(std::size_t per_face) {
  BlurredCube out;
  shapes::Random random(7);
  const double h = 1 / std::sqrt(static_cast<double>(per_face));
  for (std::size_t face = 0; face < 6; ++face) {
    for (std::size_t i = 0; i < per_face; ++i) {
      Vec3 p{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
      Vec3 n{0, 0, 0};
      n[face / 2] = face % 2 == 0 ? -1 : 1;
      p[face / 2] = 0.5 * n[face / 2];
      out.cube.points.push_back(p);
      out.cube.normals.push_back(n);
    }
  }
  for (const Vec3& p : out.cube.points) {
    Vec3 sum{0, 0, 0};
    for (std::size_t j = 0; j < out.cube.points.size(); ++j) {
      const Vec3& q = out.cube.points[j];
      const double squared = (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
      if (squared > 2.25 * h * h) continue;
      for (std::size_t a = 0; a < 3; ++a) sum[a] += out.cube.normals[j][a];
    }
    const double size = std::hypot(sum[0], sum[1], sum[2]);
    out.blurred.push_back({sum[0] / size, sum[1] / size, sum[2] / size});
  }
  return out;
}

TEST(Creases, OfPiecewiseSmoothShapesAreSharpened) {
  const BlurredCube input = blurred_cube(1000);
  std::vector<Vec3> normals = input.blurred;
  EXPECT_TRUE(sharpen_creases(PointSet(input.cube.points), normals));
  EXPECT_LE(shapes::angle_error(normals, input.cube.normals), shapes::angle_error(input.blurred, input.cube.normals) / 2);
  EXPECT_GE(shapes::share_correct(normals, input.cube.normals), 0.999);
}

TEST(Creases, RoughSurfacesStayAsTheyAre) {
  shapes::Random random(3);
  Surface rough = shapes::sphere(6000, 0.5);
  std::vector<Vec3> normals = rough.normals;
  for (Vec3& n : normals) {
    const Vec3 tilt = random.direction();
    for (std::size_t a = 0; a < 3; ++a) n[a] += 0.4 * tilt[a];
    const double size = std::hypot(n[0], n[1], n[2]);
    for (double& c : n) c /= size;
  }
  const std::vector<Vec3> before = normals;
  EXPECT_FALSE(sharpen_creases(PointSet(rough.points), normals));
  EXPECT_EQ(normals, before);
  normals = rough.normals;
  EXPECT_FALSE(sharpen_creases(PointSet(rough.points), normals));
  EXPECT_EQ(normals, rough.normals);
}

// The surroundings of a tile are thinned, and so more rounded.
TEST(Creases, OfWantedPointsDecide) {
  const BlurredCube input = blurred_cube(1000);
  Surface all = input.cube;
  std::vector<Vec3> blurred = input.blurred;
  shapes::Random random(3);
  for (const Vec3& p : shapes::sphere(12000, 0.5, {3, 0, 0}).points) {
    all.points.push_back(p);
    blurred.push_back(random.direction());
  }
  std::vector<std::uint8_t> wanted(all.points.size(), 0);
  std::fill_n(wanted.begin(), input.blurred.size(), std::uint8_t{1});
  const PointSet set(all.points);
  std::vector<Vec3> normals = blurred;
  EXPECT_FALSE(sharpen_creases(set, normals));
  EXPECT_TRUE(sharpen_creases(set, normals, wanted));
  normals.resize(input.blurred.size());
  EXPECT_LE(shapes::angle_error(normals, input.cube.normals), shapes::angle_error(input.blurred, input.cube.normals) / 2);
}

}  // namespace
}  // namespace g3r
