// What a report says of a mesh, and what is planned for it.
#pragma once

#include "field/oriented_cloud.h"
#include "field/points_with_normals.h"
#include "mesh_run.h"

#include <g3r/g3r.h>

#include <cstddef>

namespace g3r {

/// The memory in bytes that orientation and mesh take, which come one after the other: `stats` has that of the orientation and what is
/// known of the points. What Open3D will take is not known. `options`: with the mesher chosen.
[[nodiscard]] std::size_t planned_with_mesh(const Stats& stats, const MeshOptions& options);

/// What is known before the mesh of points that came with their normals, with a warning for each kind of them that was left out. `given`:
/// what `oriented` was made of; `options`: with the mesher chosen.
[[nodiscard]] Stats describe_oriented(const PointsWithNormals& given, const OrientedCloud& oriented, const MeshOptions& options);

/// Adds to `stats` the depth, the memory that was needed, and a warning for each thing that is doubtful of the mesh: surface far from all
/// points or with points of none, points without surface or on that of the other side, trimming that did nothing or too much, handles and
/// parts that the points cannot carry, more triangles than were asked for, a mesh that is not closed or not manifold. `options`: with the
/// mesher chosen.
void describe_mesh(const MeshCheck& check, const MeshRun& run, const MeshOptions& options, Stats& stats);

}  // namespace g3r
