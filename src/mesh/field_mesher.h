// From oriented points and their winding field to a triangle mesh: closed, 2-manifold, outward. docs/meshing.md explains the steps.
#pragma once

#include <g3r/g3r.h>

#include <vector>

#include "mesh/field_sampler.h"

namespace g3r {

/// Meshes N points with N outward normals (any length but zero) whose winding field `sampler` evaluates; finite, at least 4 points.
/// Closed and 2-manifold unless trimmed; the same bytes for any number of threads. An empty mesh if the field has no inside.
/// O(N log N) time. Throws InvalidInput (sizes that differ, too few points, an option out of range), Cancelled, std::bad_alloc.
[[nodiscard]] Mesh field_mesh(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const FieldSampler& sampler,
                              const MeshOptions& options = {}, const Monitor& monitor = {});

/// An upper bound of the memory that field_mesh() and the rest of reconstruct() take for N points of a typical spacing in a box with this
/// longest side (same units), in bytes; depth 0: automatic. About twice what smooth shapes need, because thin walls are not known ahead.
[[nodiscard]] std::size_t field_mesh_memory(std::size_t points, double spacing, double longest_side, int depth);

}  // namespace g3r
