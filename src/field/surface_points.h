// The oriented points that a mesh is made of: those that a surface goes through.
#pragma once

#include "field/oriented_cloud.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// Unit vectors along area vectors; (0, 0, 1) for those that are 0. O(N).
[[nodiscard]] std::vector<Vec3> directions_of(const std::vector<Vec3>& eta);

/// Leaves out the points that no surface holds (mesh::held_points()), takes strays back that the surface of the others goes through
/// (mesh::normals_of_regained()), and leaves out parts that are no surface (mesh::points_of_parts()). If far ones were left out, the others
/// get a frame of their own, which resolves them. Areas follow the spacing where that changes, and `spacing` is of the points that stay;
/// their numbers do not lead to the input any more. `strays`: places in the frame of the cloud, ascending, each once; in the end all that
/// are left out, in the frame that the cloud has then. O(N log N) a round of taking back. Throws Cancelled.
void keep_surface_points(OrientedCloud& oriented, std::vector<Vec3>& strays, const std::atomic<bool>* cancel);

}  // namespace g3r
