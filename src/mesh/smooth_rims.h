// Rims of open meshes as clean lines.
#pragma once

#include <g3r/mesh.h>

#include <functional>
#include <vector>

namespace g3r::mesh {

/// Smooths the boundary of a 2-manifold along itself: its vertices move within the surface towards the middle between the next two of the
/// boundary, and those of three rings inwards follow towards the mean of theirs. Vertices of triangles that would turn over stay, and so do
/// those that `allowed` (a byte for each place) refuses. Connectivity stays. O(V + F).
void smooth_rims(Mesh& mesh, const std::function<std::vector<std::uint8_t>(const std::vector<Vec3>&)>& allowed);

}  // namespace g3r::mesh
