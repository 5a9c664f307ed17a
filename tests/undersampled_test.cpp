// Where the surface bends more than its points say.
#include "mesh/undersampled.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cloud/neighbours.h"
#include "field_shapes.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

std::size_t marked(const OrientedSample& sample) {
  const std::vector<std::uint8_t> rough = mesh::undersampled_points(sample.normals, Neighbours(sample.points).of_all(16));
  return static_cast<std::size_t>(std::count(rough.begin(), rough.end(), std::uint8_t{1}));
}

TEST(Undersampled, SmoothSurfacesAreNot) { EXPECT_EQ(marked(sphere_sample(2000, 1, 1)), 0U); }

// Points beside edges and in most corners have enough beside them in their own side.
TEST(Undersampled, CreasesAreNot) {
  const OrientedSample cube = cube_sample(5000, 1, 1);
  EXPECT_LT(marked(cube), cube.points.size() / 100);
}

// Ten points say little of a ball, and normals at random nothing.
TEST(Undersampled, SurfaceThatTurnsFromPointToPointIs) {
  OrientedSample random = sphere_sample(2000, 1, 1);
  random.normals = sphere_sample(2000, 1, 2).points;
  EXPECT_GT(marked(random), random.points.size() * 9 / 10);
  OrientedSample balls;
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(0, 100);
  for (std::uint64_t k = 0; k < 50; ++k) {
    const Vec3 centre{uniform(rng), uniform(rng), uniform(rng)};
    const OrientedSample ball = sphere_sample(10, 1, k);
    for (std::size_t i = 0; i < ball.points.size(); ++i) {
      balls.points.push_back({ball.points[i][0] + centre[0], ball.points[i][1] + centre[1], ball.points[i][2] + centre[2]});
      balls.normals.push_back(ball.normals[i]);
    }
  }
  EXPECT_EQ(marked(balls), balls.points.size());
}

}  // namespace
