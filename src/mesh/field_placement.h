// Where the vertices of the dual surface go: on the fitted surface, on its creases and corners where a leaf holds one.
#pragma once

#include "mesh/field_contour.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_octree.h"

#include <atomic>
#include <vector>

namespace g3r::mesh {

struct PlacedVertices {
  std::vector<Vec3> positions;  ///< one per vertex of the surface
  std::vector<Vec3> normals;    ///< one per patch, unit, outward
};

/// `value`: one per corner, positive inside, zero on the surface; only ratios across an edge matter.
/// A vertex stays within kDiscHalf of the side of its leaf about it. `wanted`: empty, or 1 for each patch to place; the others stay at the
/// origin. O(vertices). Throws Cancelled.
[[nodiscard]] PlacedVertices place_vertices(const Octree& octree, const DualSurface& surface, const std::vector<float>& value,
                                            const LocalFit& local, const std::atomic<bool>* cancel = nullptr,
                                            const std::vector<std::uint8_t>& wanted = {});

}  // namespace g3r::mesh
