// Makes a surface manifold where parts of it touch.
#pragma once

#include <g3r/mesh.h>

namespace g3r {

/// Cuts the mesh apart where it touches itself: at edges with more than two triangles and at vertices with more than one fan.
/// The surface as a set of points, its orientation, volume and area stay as they are; parts that touched still do, but no longer share
/// vertices. What the triangles around an edge bound is kept together: two solids that touch in an edge come apart there.
///
/// If every edge has as many triangles in one direction as in the other (any surface that bounds a solid), the result is closed and
/// manifold. Edges for which this does not hold, such as boundaries, stay as they are. Triangles that name a vertex twice, and pairs that
/// face each other on the same three vertices, are left out: they bound nothing. A mesh without such places is returned unchanged. O(F log
/// F). Indices must be valid.
[[nodiscard]] Mesh split_nonmanifold(Mesh mesh);

}  // namespace g3r
