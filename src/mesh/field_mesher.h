// From oriented points and their winding field to a triangle mesh: closed, 2-manifold, outward. docs/algorithms/mesher.md explains.
#pragma once

#include "mesh/field_sampler.h"
#include "mesh/mesh_finish.h"
#include "mesh/mesh_memory.h"

#include <g3r/g3r.h>

#include <vector>

namespace g3r {

/// Meshes N points with N outward normals (any length but zero) whose winding field `sampler` evaluates; finite, at least 4 points.
/// Closed and 2-manifold unless trimmed; the same bytes for any number of threads. An empty mesh if the field has no inside.
/// Simplifies nothing (MeshOptions::faces). Lengths in `options` are in the units of the points, the noise too unless it is automatic.
/// `memory` and `found` (may be null): the latter as of finish_mesh(). O(N log N) time. Throws InvalidInput (sizes that differ, too few
/// points, an option out of range), Unavailable (beyond the limit), Cancelled, std::bad_alloc.
[[nodiscard]] Mesh field_mesh(const std::vector<Vec3>& points, std::vector<Vec3> normals, const FieldSampler& sampler,
                              const MeshOptions& options = {}, const Monitor& monitor = {}, MeshMemory* memory = nullptr,
                              mesh::Found* found = nullptr);

}  // namespace g3r
