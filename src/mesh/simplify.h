// Fewer triangles, by collapsed edges.
//
// Garland, Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997, with vertices that stay where they are.
#pragma once

#include <g3r/mesh.h>

#include <atomic>
#include <cstddef>

namespace g3r::mesh {

/// Collapses the edges whose collapse moves the surface least (the squared distance from the planes of all triangles that a vertex stands
/// for, times their areas) onto one of their ends, until `faces` triangles are left, or one less. Where it moves nothing, as in facets,
/// those that make no slivers come first. Closedness, manifoldness, components, genus and the number of boundaries stay, and no triangle
/// turns over or loses its area, so that more triangles are left where fewer are not enough for that. Vertices that are left stay where
/// they are, with their attributes. O(V log V). Throws Cancelled.
void simplify(Mesh& mesh, std::size_t faces, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
