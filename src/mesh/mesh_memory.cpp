#include "mesh/mesh_memory.h"

#include "base/whole_bytes.h"
#include "cloud/canonical_cloud.h"
#include "mesh/constants.h"
#include "mesh/field_corners.h"
#include "mesh/field_points.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace g3r {
namespace {

// Peak memory, measured (docs/evidence/meshes.md). If it is planned too small a run is killed, if too large it is refused for nothing.
constexpr double kBaseBytes = 25 * kMebibyte;  // Code, libraries, the stacks of threads, and queries of a sum take so many.
constexpr double kBytesPerPoint = 340;         // A point takes so many, those of the winding field included.
constexpr double kBytesPerLeaf = 95;           // A leaf takes so many,
constexpr double kBytesPerThinLeaf = 270;      // and one of a thin wall or gap so many: most of its corners are ambiguous.
constexpr double kPlainLeaves = 8.6;           // A point of a shape without thin walls has 5.7 to 8.6 leaves; what exceeds this is thin.

// `depth`: 0 for the automatic one.
std::size_t memory_for(std::size_t points, double leaves, int depth) {
  const double thin = depth > 0 ? 0 : std::max(0.0, leaves - kPlainLeaves * static_cast<double>(points));
  return whole_bytes(kBaseBytes + kBytesPerPoint * static_cast<double>(points) + kBytesPerLeaf * (leaves - thin) +
                     kBytesPerThinLeaf * thin);
}

}  // namespace

double mesh::octree_side(double spacing, double longest_side) { return 2 / kBoxSide * longest_side + 2 * kFarSpacings * spacing; }

std::size_t field_mesh_memory(std::size_t points, double spacing, double noise, double longest_side, int depth) {
  double leaves = kPlainLeaves;
  if (depth == 0 && spacing > 0) {
    const double larger = mesh::cell_under(mesh::noise_seen({noise / spacing, 0})) / mesh::kFinestCell;
    leaves /= larger * larger;
  }
  if (depth > 0 && longest_side > 0) {
    // The layer that is refined is so many cells of the automatic depth thick.
    const double thickness = 2 * mesh::kDiscHalf / mesh::kFinestCell;
    // So many cells of its own are as wide as one of the automatic depth; a finer one refines the layer and one cell on both sides of it.
    // Nine points at depth 10 took 2.3 GiB of 3.3 planned so.
    const double finer = mesh::kFinestCell * spacing * std::exp2(depth) / mesh::octree_side(spacing, longest_side);
    leaves *= std::max(1.0, finer * finer * (thickness * finer + 2) / (thickness + 2));
  }
  // Clouds of few points have no more leaves beside than the base level: 300 on a sphere have 3,300, 1,500 have 2,000.
  const double base = std::exp2(3 * mesh::kBaseLevel);
  return memory_for(points, leaves * static_cast<double>(points) + (depth == 0 ? base : 0), depth);
}

void mesh::check_memory(std::size_t points, std::size_t leaves, int depth, MeshMemory& memory) {
  memory.needed = memory_for(points, static_cast<double>(leaves), depth);
  if (memory.limit == 0 || memory.needed <= memory.limit) return;
  throw Unavailable("the mesh needs " + std::to_string(mebibytes_needed(memory.needed)) + " MiB, the limit is " +
                    std::to_string(mebibytes(memory.limit)) + " MiB; raise the limit, lower the depth or thin the cloud");
}

}  // namespace g3r
