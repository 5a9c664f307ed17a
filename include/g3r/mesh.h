// Triangle meshes, and what can be said of them.
#pragma once

#include <g3r/export.h>
#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace G3R_PUBLIC g3r {

/// An indexed triangle mesh. Triangles are counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> vertices;                           ///< V positions, in the units of the input
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< F index triples into vertices
  std::vector<std::array<std::uint8_t, 3>> colors;      ///< empty, or V RGB triples
  std::vector<float> confidence;                        ///< empty, or V values in [0, 1]
};

/// Topology and size of a mesh, see check_mesh().
struct MeshCheck {
  std::size_t vertices = 0;  ///< vertices that a triangle uses
  std::size_t triangles = 0;
  std::size_t components = 0;            ///< connected through shared edges
  std::size_t boundary_edges = 0;        ///< edges with one triangle
  std::size_t nonmanifold_edges = 0;     ///< edges with more than two triangles, or two of inconsistent winding
  std::size_t nonmanifold_vertices = 0;  ///< vertices whose triangles do not form one fan
  bool closed = false;                   ///< at least one triangle, no boundary edge and every edge shared by exactly two
  bool manifold = false;                 ///< no non-manifold edge or vertex
  long genus = 0;                        ///< sum over components of (2 - Euler characteristic) / 2; 0 unless closed and manifold
  double volume = 0;                     ///< signed, by the divergence theorem; positive when oriented outward
  double area = 0;
};

/// Topology, genus, volume and area of a mesh. O(F log F). A triangle that names a vertex twice has a non-manifold edge.
/// Throws InvalidInput if a triangle names a vertex that does not exist, or one with a coordinate that is not finite or beyond 1e50.
[[nodiscard]] MeshCheck check_mesh(const Mesh& mesh);

}  // namespace g3r
