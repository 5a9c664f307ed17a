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

}  // namespace g3r
