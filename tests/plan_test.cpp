// plan(): what a run would take, with a mesh and without.
#include <g3r/g3r.h>

#include "shapes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace g3r {
namespace {

TEST(Plan, HasTheMeshInIt) {
  const std::vector<Vec3> points = shapes::torus(20000, 0.6, 0.25, 1).points;
  const std::size_t orient_only = plan(points).planned_memory_bytes;
  MeshOptions mesh;
  const std::size_t automatic = plan(points, {}, mesh).planned_memory_bytes;
  EXPECT_GT(automatic, orient_only);
  mesh.depth = 10;
  EXPECT_GT(plan(points, {}, mesh).planned_memory_bytes, 4 * automatic);
}

TEST(Plan, ThePaperPresetGivesTheFieldMesherNoDepth) {
  const std::vector<Vec3> points = shapes::sphere(9).points;
  Options paper;
  paper.preset = Preset::kPaper;
  MeshOptions field;
  field.mesher = Mesher::kField;
  EXPECT_EQ(plan(points, paper, field).depth, 0);
  EXPECT_LT(plan(points, paper, field).planned_memory_bytes, std::size_t{64} << 20);
}

}  // namespace
}  // namespace g3r
