// Topology and size of a triangle mesh.
//
// The three sides of all triangles are sorted by their end points; equal neighbours are the triangles that meet at one edge.
// Two union-find passes over them give the components (triangles joined by edges) and the fans (corners joined by edges
// around their vertex): a vertex with more than one fan is a bow-tie.
#include <g3r/error.h>
#include <g3r/mesh.h>

#include <algorithm>
#include <numeric>

#include "cpu/parallel.h"
#include "mesh/used_vertices.h"
#include "mesh/vector.h"

namespace g3r {

namespace {

using vector::cross;
using vector::dot;
using vector::subtract;

/// Disjoint sets of 0..n-1 with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n), count_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    if (i == j) return;
    parent_[std::max(i, j)] = std::min(i, j);
    --count_;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<std::size_t> parent_;
  std::size_t count_;
};

/// One side of a triangle: from corner `corner` (3 f + k) to the next corner of f. low <= high are its vertices.
struct Side {
  std::uint32_t low;
  std::uint32_t high;
  std::size_t corner;
};

std::size_t next_corner(std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/// All 3F sides; those of one edge are adjacent.
std::vector<Side> sorted_sides(const Mesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[f][k];
      const std::uint32_t to = mesh.triangles[f][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), 3 * f + k});
    }
  }
  parallel::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.corner < b.corner;
  });
  return sides;
}

/// Counts edges and vertices, joins triangles and corners across edges, and fills in the topological fields.
class Topology {
 public:
  explicit Topology(const Mesh& mesh)
      : mesh_(mesh), triangles_(mesh.triangles.size()), corners_(3 * mesh.triangles.size()), bad_vertex_(mesh.vertices.size(), 0) {
    const std::vector<Side> sides = sorted_sides(mesh);
    for (std::size_t begin = 0; begin < sides.size();) {
      std::size_t end = begin + 1;
      while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high) ++end;
      add_edge(sides.data() + begin, end - begin);
      begin = end;
    }
  }

  void fill(MeshCheck& check) {
    std::vector<char> fans(mesh_.vertices.size(), 0);  // 0, 1, or 2 for more
    for (std::size_t c = 0; c < 3 * mesh_.triangles.size(); ++c) {
      if (corners_.find(c) == c) fans[vertex(c)] = static_cast<char>(std::min(2, fans[vertex(c)] + 1));
    }
    for (std::size_t v = 0; v < fans.size(); ++v) {
      check.vertices += fans[v] > 0 ? 1 : 0;
      check.nonmanifold_vertices += fans[v] > 1 || bad_vertex_[v] != 0 ? 1 : 0;
    }
    check.triangles = mesh_.triangles.size();
    check.components = triangles_.count();
    check.boundary_edges = boundary_edges_;
    check.nonmanifold_edges = nonmanifold_edges_;
    check.closed = check.triangles > 0 && edges_not_of_two_ == 0;
    check.manifold = check.nonmanifold_edges == 0 && check.nonmanifold_vertices == 0;
    if (check.closed && check.manifold) {
      // Sum over components of (2 - (V - E + F)) / 2.
      const long euler = static_cast<long>(check.vertices) - static_cast<long>(edges_) + static_cast<long>(check.triangles);
      check.genus = (2 * static_cast<long>(check.components) - euler) / 2;
    }
  }

 private:
  [[nodiscard]] std::uint32_t vertex(std::size_t corner) const { return mesh_.triangles[corner / 3][corner % 3]; }

  /// `sides`: the `count` sides between the same two vertices.
  void add_edge(const Side* sides, std::size_t count) {
    ++edges_;
    const bool loop = sides[0].low == sides[0].high;  // a triangle that names a vertex twice
    std::size_t forward = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (vertex(sides[i].corner) == sides[0].low) ++forward;
      if (i == 0 || loop) continue;
      triangles_.join(sides[0].corner / 3, sides[i].corner / 3);
      corners_.join(corner_at(sides[0], sides[0].low), corner_at(sides[i], sides[0].low));
      corners_.join(corner_at(sides[0], sides[0].high), corner_at(sides[i], sides[0].high));
    }
    if (loop || count != 2) ++edges_not_of_two_;
    if (count == 1 && !loop) ++boundary_edges_;
    if (loop || count > 2 || (count == 2 && forward != 1)) ++nonmanifold_edges_;
    if (loop || count > 2) bad_vertex_[sides[0].low] = bad_vertex_[sides[0].high] = 1;
  }

  [[nodiscard]] std::size_t corner_at(const Side& side, std::uint32_t v) const {
    return vertex(side.corner) == v ? side.corner : next_corner(side.corner);
  }

  const Mesh& mesh_;
  DisjointSets triangles_;
  DisjointSets corners_;
  std::vector<char> bad_vertex_;
  std::size_t edges_ = 0;
  std::size_t boundary_edges_ = 0;
  std::size_t nonmanifold_edges_ = 0;
  std::size_t edges_not_of_two_ = 0;
};

/// Signed volume and area. Coordinates are taken from the box centre, so that large offsets cost no digits.
void measure(const Mesh& mesh, const Vec3& centre, MeshCheck& check) {
  for (const auto& t : mesh.triangles) {
    const Vec3 a = subtract(mesh.vertices[t[0]], centre);
    const Vec3 b = subtract(mesh.vertices[t[1]], centre);
    const Vec3 c = subtract(mesh.vertices[t[2]], centre);
    const Vec3 n = cross(subtract(b, a), subtract(c, a));
    check.volume += dot(a, n) / 6;  // div x = 3 integrated over the tetrahedron (centre, a, b, c)
    check.area += std::sqrt(dot(n, n)) / 2;
  }
}

}  // namespace

MeshCheck check_mesh(const Mesh& mesh) {
  MeshCheck check;
  const vector::Box box = box_of_used_vertices(mesh);
  if (mesh.triangles.empty()) return check;
  Topology(mesh).fill(check);
  measure(mesh, box.centre(), check);
  return check;
}

}  // namespace g3r
