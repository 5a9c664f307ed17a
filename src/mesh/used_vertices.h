// The vertices that triangles use: validation shared by everything that takes a mesh.
#pragma once

#include "base/vector.h"

#include <g3r/mesh.h>

namespace g3r {

/// The largest coordinate that can be worked with: products of up to six of them, the most that areas, volumes and distances need, are
/// finite.
inline constexpr double kLargestCoordinate = 1e50;

/// Box of the vertices that a triangle uses; empty for a mesh without triangles. O(F).
/// Throws InvalidInput if a triangle names a vertex that does not exist, or one with a non-finite or unusably large coordinate.
[[nodiscard]] vector::Box box_of_used_vertices(const Mesh& mesh);

}  // namespace g3r
