// Components of a mesh, and removal of triangles, components and unused vertices.
#pragma once

#include <g3r/mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Components (connected through shared vertices).
struct Components {
  std::vector<std::uint32_t> of;  ///< F: component of every triangle, numbered in order of first use
  std::size_t count = 0;
};
/// O(V + F).
[[nodiscard]] Components find_components(const Mesh& mesh);

/// The mean of the corners of a triangle.
[[nodiscard]] Vec3 centre_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle);
/// Of every triangle.
[[nodiscard]] std::vector<Vec3> centres_of(const Mesh& mesh);
/// In squared units of the mesh.
[[nodiscard]] double area_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle);
/// Of every vertex, the mean of the triangles around it by area; unit, (0, 0, 0) where there is none.
[[nodiscard]] std::vector<Vec3> vertex_normals(const Mesh& mesh);

/// Removes the components of which keep[component] == 0, and vertices that are no longer used. Order is kept, so a closed manifold stays
/// one. O(V + F).
void remove_components(Mesh& mesh, const Components& components, const std::vector<std::uint8_t>& keep);

/// Removes the vertices that no triangle uses; the others are numbered in order of first use. O(V + F).
void drop_unused_vertices(Mesh& mesh);

/// Removes triangles (keep[t] == 0) and the vertices that no longer belong to one. Where the rest touches itself at a single vertex,
/// that vertex is doubled, so that a 2-manifold stays one, with boundary. O(V + F).
void remove_triangles(Mesh& mesh, const std::vector<std::uint8_t>& keep);

}  // namespace g3r::mesh
