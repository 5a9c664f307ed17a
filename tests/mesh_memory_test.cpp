// The memory plan of meshes: what it follows, and what it refuses.
#include "mesh/mesh_memory.h"

#include <g3r/error.h>
#include <g3r/names.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "field_shapes.h"
#include "mesh/field_mesher.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

constexpr std::size_t kPoints = 100000;
constexpr double kSpacing = 0.003, kSide = 1;

double planned(std::size_t points, double noise = 0, int depth = 0) {
  return static_cast<double>(field_mesh_memory(points, kSpacing, noise, kSide, depth));
}

TEST(MeshMemory, GrowsAsThePointsDo) {
  const double step = planned(2 * kPoints) - planned(kPoints);
  EXPECT_NEAR(planned(4 * kPoints) - planned(2 * kPoints), 2 * step, 2);  // bytes are whole
  EXPECT_LT(planned(2 * kPoints), 2 * planned(kPoints));                  // the rest of the program is there once
}

// Fits of noisy points are wider, and so are leaves.
TEST(MeshMemory, IsLessUnderNoiseAndMoreForFinerLeaves) {
  EXPECT_LT(planned(kPoints, 2 * kSpacing), planned(kPoints));
  for (int depth = kLeastMeshDepth; depth < kMostMeshDepth; ++depth) {
    EXPECT_LE(planned(kPoints, 0, depth), planned(kPoints, 0, depth + 1)) << depth;
  }
  EXPECT_LT(planned(kPoints, 0, kLeastMeshDepth), planned(kPoints, 0, kMostMeshDepth));
}

// Of a surface without thin walls it is what its octree shows, and no more leaves than planned are at the higher price of thin ones.
TEST(MeshMemory, IsThatOfTheOctreeWithoutThinWalls) {
  constexpr std::size_t kFew = 5000;
  constexpr double kTolerance = 0.1;
  const OrientedSample sphere = sphere_sample(kFew, 1, 1);
  DistanceSampler field([](const Vec3& p) { return std::hypot(p[0], p[1], p[2]) - 1; }, 0.1);
  MeshMemory memory;
  (void)field_mesh(sphere.points, sphere.normals, field, {}, {}, &memory);
  const double spacing = std::sqrt(4 * std::numbers::pi / kFew);
  const auto before = static_cast<double>(field_mesh_memory(kFew, spacing, 0, 2, 0));
  EXPECT_NEAR(static_cast<double>(memory.needed) / before, 1, kTolerance);
}

// A point of a surface without thin walls has 8 leaves or so; further ones are in thin walls, where most corners are ambiguous.
TEST(MeshMemory, LeavesOfThinWallsTakeMore) {
  const auto needed = [](std::size_t leaves_per_point) {
    MeshMemory memory;
    mesh::check_memory(kPoints, leaves_per_point * kPoints, 0, memory);
    return memory.needed;
  };
  EXPECT_GT(needed(16) - needed(8), 2 * (needed(8) - needed(0)));
}

TEST(MeshMemory, IsRefusedBeyondTheLimitOnly) {
  MeshMemory memory;
  mesh::check_memory(kPoints, 8 * kPoints, 0, memory);
  memory.limit = memory.needed;
  EXPECT_NO_THROW(mesh::check_memory(kPoints, 8 * kPoints, 0, memory));
  --memory.limit;
  EXPECT_THROW(mesh::check_memory(kPoints, 8 * kPoints, 0, memory), Unavailable);
}

// Nothing of a cloud is near the boundary, beyond which all is outside.
TEST(MeshMemory, TheOctreeHasRoomForFourSpacingsOnEverySide) {
  EXPECT_GT(mesh::octree_side(kSpacing, kSide), kSide + 2 * 4 * kSpacing);
  EXPECT_GT(mesh::octree_side(0, kSide), kSide);
}

}  // namespace
