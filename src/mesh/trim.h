// Surface that nobody measured, cut away.
#pragma once

#include "mesh/field_local_fit.h"

#include <g3r/g3r.h>

#include <atomic>

namespace g3r::mesh {

/// Cuts off what is farther from every point than `trim_distance`, or (auto) than 4 spacings: of the cloud, or of the place where that is
/// denser; 1.4 of the place where it is so sparse that this is more. What spans gaps stays so, but at the rims of an open scan surface goes
/// on as far for nothing: from there inwards (auto) all goes that is past the rims of the points, where as many of these are missing as on
/// the other side of an edge, and what is turned away from their normals. The mesh is cut between its vertices, and its rims are smoothed
/// (smooth_rims) within the same distances. Nothing happens to surface that is nowhere too far: then false is returned. `mesh`: without
/// colours. O((F + N) log N). Throws InvalidInput if nothing would be left; Cancelled.
bool trim(Mesh& mesh, const OrientedPoints& points, const MeshOptions& options, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
