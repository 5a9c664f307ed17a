// Triangle meshes, and what can be said of them.
#pragma once

#include <g3r/export.h>
#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace G3R_PUBLIC g3r {

/// An indexed triangle mesh. Triangles are counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> vertices;                           ///< V positions, in the units of the input
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< F index triples into vertices
  std::vector<std::array<std::uint8_t, 3>> colors;      ///< empty, or V RGB triples
  std::vector<float> confidence;                        ///< empty, or V values in [0, 1]
};

/// What a mesher left out for want of support, see MeshOptions::keep_all.
struct Dropped {
  std::size_t points = 0;      ///< distinct outliers and strays: no surface goes through them
  std::size_t components = 0;  ///< that too few points hold
  double area = 0;             ///< of these components
};

/// Topology, size and shape of a mesh, see check_mesh().
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
  double volume = 0;                     ///< cubed units of the mesh, signed, by the divergence theorem; positive when oriented outward
  double area = 0;                       ///< squared units of the mesh
  double min_angle = 0;                  ///< degrees, the smallest of all triangles; 0 if one has no area
  double median_min_angle = 0;           ///< degrees, median over the triangles of their smallest angle
  double max_aspect = 0;  ///< largest ratio of longest side to the height on it, 2/sqrt(3) for equilateral ones; infinite without area
  Dropped dropped;        ///< by the mesher; check_mesh() leaves it empty
  std::optional<std::size_t> self_intersections;  ///< count_self_intersections(), where that was asked for; check_mesh() leaves it empty
};

/// Topology, genus, volume and area of a mesh. O(F log F). A triangle that names a vertex twice has a non-manifold edge.
/// Throws InvalidInput if a triangle names a vertex that does not exist, or one with a coordinate that is not finite or beyond 1e50.
[[nodiscard]] MeshCheck check_mesh(const Mesh& mesh);

/// Number of pairs of triangles that have a point in common but no corner (by position). Decided exactly, in the coordinates as they are,
/// unless the sizes of coordinates differ by more than a factor of 1e90. Triangles whose area rounds to 0 are left out, and so are folds
/// between triangles that share a corner. 0 for a mesh without triangles. O(F log F + pairs). Throws InvalidInput like check_mesh().
[[nodiscard]] std::size_t count_self_intersections(const Mesh& mesh);

}  // namespace g3r
