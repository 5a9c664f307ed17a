// Parts of a mesh: connected components by size, and surface far from the points.
#pragma once

#include <g3r/mesh.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r::mesh {

/// Removes the components (connected through shared vertices) that less than `least` points stand for, and all but the `keep_largest`
/// largest by area (0: no limit; ties: the one that comes first). `per_point`: the area that one point stands for about a place. The
/// largest component always stays. Vertices that are no longer used go too; order is kept, so a closed manifold stays one. O(V + F).
void remove_components(Mesh& mesh, double least, const std::function<double(const Vec3&)>& per_point, std::size_t keep_largest);

/// Removes the vertices that no triangle uses; the others are numbered in order of first use. O(V + F).
void drop_unused_vertices(Mesh& mesh);

/// Removes triangles (keep[t] == 0) and the vertices that no longer belong to one. Where the rest touches itself at a single vertex,
/// that vertex is doubled, so that a 2-manifold stays one, with boundary. O(V + F).
void remove_triangles(Mesh& mesh, const std::vector<std::uint8_t>& keep);

}  // namespace g3r::mesh
