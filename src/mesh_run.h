// From oriented points to a mesh in the units of the caller.
#pragma once

#include "field/oriented_cloud.h"
#include "mesh/component_support.h"
#include "mesh/mesh_finish.h"
#include "mesh/mesh_memory.h"

#include <g3r/g3r.h>

#include <cstddef>

namespace g3r {

/// What making a mesh starts with and finds out.
struct MeshRun {
  mesh::Found found;              ///< `strays`: in, the points that were left out before, in input units
  MeshMemory memory;              ///< `limit`: in
  mesh::Unmet unmet{};            ///< 0 where options ask for less than all of the surface
  double far_share = 0;           ///< of the surface, farther than mesh::kFarSpacings from every point
  std::size_t new_crossings = 0;  ///< pairs of triangles that intersect since there are fewer
  Vec3 box_centre{0, 0, 0};       ///< of the points that the mesh is made of, in input units like the lengths below
  double box_side = 0;            ///< the longest of that box
  double spacing = 0;             ///< typical, of these points
  double noise = 0;               ///< their standard deviation, as given or found
};

/// Whether the finest octree there is does not resolve the spacing of points in a box with this longest side, same units.
[[nodiscard]] bool is_too_wide(double box_side, double spacing, const MeshOptions& options);

/// Meshes in the unit frame, so that georeferenced coordinates lose nothing, and maps back. What is inside out is meshed as the solid that
/// it surrounds, and the triangles are turned. `options`: with the mesher chosen, lengths in input units. Throws InvalidInput where there
/// is no surface, what field_mesh() throws, and Cancelled.
[[nodiscard]] Mesh make_mesh(OrientedCloud oriented, const MeshOptions& options, const Monitor& monitor, MeshRun& run);

}  // namespace g3r
