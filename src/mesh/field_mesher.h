// From oriented points and their winding field to a triangle mesh: closed, 2-manifold, outward. docs/algorithms/mesher.md explains.
#pragma once

#include "mesh/field_sampler.h"
#include "mesh/mesh_finish.h"

#include <g3r/g3r.h>

#include <vector>

namespace g3r {

/// Meshes N points with N outward normals (any length but zero) whose winding field `sampler` evaluates; finite, at least 4 points.
/// Closed and 2-manifold unless trimmed; the same bytes for any number of threads. An empty mesh if the field has no inside.
/// Lengths in `options` are in the units of the points, the noise too unless it is automatic. `max_memory` (0: no limit): of field_mesh()
/// and the rest of reconstruct(), in bytes; looked at once the octree shows what is needed. `left_out` (may be null): as of finish_mesh().
/// O(N log N) time. Throws InvalidInput (sizes that differ, too few points, an option out of range), Unavailable (beyond max_memory),
/// Cancelled, std::bad_alloc.
[[nodiscard]] Mesh field_mesh(const std::vector<Vec3>& points, std::vector<Vec3> normals, const FieldSampler& sampler,
                              const MeshOptions& options = {}, const Monitor& monitor = {}, std::size_t max_memory = 0,
                              mesh::LeftOut* left_out = nullptr);

/// The memory that field_mesh() and the rest of reconstruct() take for N points of a typical spacing and noise in a box with this longest
/// side (same units), in bytes; depth 0: automatic. Walls and gaps of less than about 0.7 spacings, which are not known ahead, take up to 5
/// times it.
[[nodiscard]] std::size_t field_mesh_memory(std::size_t points, double spacing, double noise, double longest_side, int depth);

}  // namespace g3r
