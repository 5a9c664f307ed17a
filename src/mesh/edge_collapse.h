// A mesh whose edges are collapsed onto one of their ends, one at a time, without a change of its topology.
#pragma once

#include "base/vector.h"
#include "mesh/constants.h"

#include <g3r/mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Vertices stay where they are and keep their numbers. Closedness, manifoldness, components and genus stay: an edge is collapsed only
/// where Dey, Edelsbrunner, Guha and Nekhayev, "Topology preserving edge contraction", 1999, show that they do. O(degree) each.
class EdgeCollapse {
 public:
  /// `mesh`: its triangles are changed in place; those that are gone are marked. O(F).
  explicit EdgeCollapse(Mesh& mesh);

  /// Whether a triangle uses the vertex.
  [[nodiscard]] bool is_used(std::uint32_t v) const { return first_[v] != kNone; }
  [[nodiscard]] const Vec3& place(std::uint32_t v) const { return mesh_.vertices[v]; }
  [[nodiscard]] double squared_length(std::uint32_t a, std::uint32_t b) const;
  /// Twice the area times the normal of a triangle, with the vertex `from` moved to `to`.
  [[nodiscard]] Vec3 normal_of(const std::array<std::uint32_t, 3>& triangle, std::uint32_t from, std::uint32_t to) const;
  [[nodiscard]] Vec3 normal_of(const std::array<std::uint32_t, 3>& triangle) const { return normal_of(triangle, kNone, kNone); }

  /// Calls body(triangle) for those around a vertex, until it returns false. Returns whether it never did.
  template <class Body>
  bool for_triangles_of(std::uint32_t v, const Body& body) const {
    for (std::uint32_t corner = first_[v]; corner != kNone; corner = next_[corner]) {
      if (is_left_[corner / 3] != 0 && !body(mesh_.triangles[corner / 3])) return false;
    }
    return true;
  }

  /// The vertices that share a triangle with v, ascending.
  void find_neighbours(std::uint32_t v, std::vector<std::uint32_t>& neighbours) const;
  /// Whether an edge belongs to one triangle.
  [[nodiscard]] bool is_boundary(std::uint32_t a, std::uint32_t b) const;

  /// Moves all triangles of `from` to `to`, the other end of an edge, if that keeps the topology; else does nothing and returns false.
  bool collapse(std::uint32_t from, std::uint32_t to);
  /// The neighbours of the vertex that collapse() has moved last, `to` among them, ascending.
  [[nodiscard]] const std::vector<std::uint32_t>& neighbours() const { return ring_; }

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Of every triangle of the mesh, whether it is left.
  [[nodiscard]] const std::vector<std::uint8_t>& is_left() const { return is_left_; }

 private:
  [[nodiscard]] std::size_t triangles_of(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] bool keeps_topology(std::uint32_t from, std::uint32_t to);

  Mesh& mesh_;
  std::size_t count_;
  std::vector<std::uint8_t> is_left_;
  std::vector<std::uint8_t> on_boundary_;    // vertices
  std::vector<std::uint32_t> first_, next_;  // corners of each vertex, one after another
  std::vector<std::uint32_t> ring_, other_, common_;
};

}  // namespace g3r::mesh
