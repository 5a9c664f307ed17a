// Least-squares meshes: some vertices of a mesh go where its surface is fair and meets given points.
//
// Sorkine, Cohen-Or, "Least-squares meshes", SMI 2004. With L x_v = x_v - (mean of the vertices around v), b the barycentric coordinates of
// an anchor in its triangle and p its place, the vertices x minimise
//   sum_v |L x_v|^2 + 1/2 sum_anchors |sum_k b_k x_k - p|^2.
#pragma once

#include <g3r/mesh.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace g3r::mesh {

/// The vertices of a mesh around each one, once each, ascending.
struct VertexRings {
  std::vector<std::uint32_t> begin, vertex;  ///< those of v at begin[v] to begin[v + 1]

  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t v) const { return {vertex.data() + begin[v], vertex.data() + begin[v + 1]}; }
};
/// O(V + F).
[[nodiscard]] VertexRings vertex_rings(const Mesh& mesh);

/// A point, and the place of a triangle that should meet it.
struct Anchor {
  std::array<std::uint32_t, 3> vertex{};
  std::array<double, 3> weight{};  ///< barycentric coordinates of the place
  Vec3 point{};
};

/// The energy above as a function of the vertices that are free.
class LeastSquaresMesh {
 public:
  /// `free`: 1 for vertices that may move. Both must outlive this. O(V).
  LeastSquaresMesh(const VertexRings& rings, const std::vector<std::uint8_t>& free);

  /// Moves the free ones of the vertices `at` towards the least energy, by conjugate gradients, until the squared residual is at most
  /// `enough`; if that is nothing yet, it becomes the share of the first residual beyond which no vertex moves visibly. The same result for
  /// any number of threads. At most 300 products with a sparse matrix of V rows. Throws Cancelled.
  void minimise(const std::vector<Anchor>& anchors, std::vector<Vec3>& at, std::optional<double>& enough, const std::atomic<bool>* cancel);

 private:
  void gradient(const std::vector<Vec3>& at, const std::vector<Anchor>& anchors, bool is_affine, std::vector<Vec3>& out);
  [[nodiscard]] Vec3 laplacian(const std::vector<Vec3>& at, std::size_t v) const;

  const VertexRings& rings_;
  const std::vector<std::uint8_t>& free_;
  std::vector<std::uint8_t> counts_;  // vertices whose Laplacian is part of the energy
  std::vector<double> inverse_;       // of the number of neighbours of each vertex
  std::vector<Vec3> shares_;          // of each neighbour, in the Laplacian of a vertex; 0 where that does not count
};

}  // namespace g3r::mesh
