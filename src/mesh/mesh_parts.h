// Parts of a mesh: connected components by size, and surface far from the points.
#pragma once

#include <g3r/mesh.h>

#include <cstddef>

namespace g3r::mesh {

/// Removes the components (connected through shared vertices) of less than `min_area`, and all but the `keep_largest` largest by area
/// (0: no limit; ties: the one that comes first). The largest component always stays. Vertices that are no longer used go too; order is
/// kept, so a closed manifold stays one. O(V + F).
void remove_components(Mesh& mesh, double min_area, std::size_t keep_largest);

/// Removes triangles (keep[t] == 0) and the vertices that no longer belong to one. Where the rest touches itself at a single vertex,
/// that vertex is doubled, so that a 2-manifold stays one, with boundary. O(V + F).
void remove_triangles(Mesh& mesh, const std::vector<std::uint8_t>& keep);

}  // namespace g3r::mesh
