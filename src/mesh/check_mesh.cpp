// Topology, size and shape of a triangle mesh.
//
// The three half-edges of all triangles are sorted by their end points; equal neighbours are the triangles that meet at one edge.
// Two union-find passes over them give the components (triangles joined by edges) and the fans (corners joined by edges
// around their vertex): a vertex with more than one fan is a bow-tie.
#include "base/degrees.h"
#include "base/disjoint_sets.h"
#include "base/median.h"
#include "base/vector.h"
#include "mesh/half_edges.h"
#include "mesh/triangle.h"
#include "mesh/used_vertices.h"

#include <g3r/error.h>
#include <g3r/mesh.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r {

namespace {

using vector::cross;
using vector::dot;
using vector::subtract;

/// Counts edges and vertices, joins triangles and corners across edges, and fills in the topological fields.
class Topology {
 public:
  explicit Topology(const Mesh& mesh)
      : mesh_(mesh), triangles_(mesh.triangles.size()), corners_(3 * mesh.triangles.size()), bad_vertex_(mesh.vertices.size(), 0) {
    for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t count) { add_edge(half_edges, count); });
  }

  void fill(MeshCheck& check) {
    std::vector<char> fans(mesh_.vertices.size(), 0);  // 0, 1, or 2 for more
    for (std::size_t c = 0; c < 3 * mesh_.triangles.size(); ++c) {
      if (corners_.find(c) == c) fans[vertex_of(mesh_, c)] = static_cast<char>(std::min(2, fans[vertex_of(mesh_, c)] + 1));
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
  /// `half_edges`: the `count` half-edges between the same two vertices.
  void add_edge(const HalfEdge* half_edges, std::size_t count) {
    ++edges_;
    const bool loop = half_edges[0].low == half_edges[0].high;  // a triangle that names a vertex twice
    std::size_t forward = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (is_forward(mesh_, half_edges[i])) ++forward;
      if (!loop) triangles_.join(half_edges[0].corner / 3, half_edges[i].corner / 3);
    }
    if (!loop) join_fans(mesh_, half_edges, count, corners_);
    if (loop || count != 2) ++edges_not_of_two_;
    if (count == 1 && !loop) ++boundary_edges_;
    if (loop || count > 2 || (count == 2 && forward != 1)) ++nonmanifold_edges_;
    if (loop || count > 2) bad_vertex_[half_edges[0].low] = bad_vertex_[half_edges[0].high] = 1;
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
    const Vec3 n = mesh::twice_area_vector(a, b, c);
    check.volume += dot(a, n) / 6;  // div x = 3 integrated over the tetrahedron (centre, a, b, c)
    check.area += std::sqrt(dot(n, n)) / 2;
  }
}

/// Angles and aspect ratios. The smallest angle lies opposite the shortest edge.
void measure_shape(const Mesh& mesh, MeshCheck& check) {
  std::vector<double> angles;
  angles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    std::array<Vec3, 3> edge{subtract(c, b), subtract(a, c), subtract(b, a)};
    std::sort(edge.begin(), edge.end(), [](const Vec3& s, const Vec3& u) { return dot(s, s) < dot(u, u); });
    const Vec3 n = cross(edge[1], edge[2]);
    const double twice_area = std::sqrt(dot(n, n));
    angles.push_back(degrees(std::atan2(twice_area, std::fabs(dot(edge[1], edge[2])))));
    const double aspect = twice_area > 0 ? dot(edge[2], edge[2]) / twice_area : HUGE_VAL;
    check.max_aspect = std::max(check.max_aspect, aspect);
  }
  check.min_angle = *std::min_element(angles.begin(), angles.end());
  check.median_min_angle = median(std::move(angles));
}

}  // namespace

MeshCheck check_mesh(const Mesh& mesh) {
  MeshCheck check;
  const vector::Box box = box_of_used_vertices(mesh);
  if (mesh.triangles.empty()) return check;
  Topology(mesh).fill(check);
  measure(mesh, box.centre(), check);
  measure_shape(mesh, check);
  return check;
}

}  // namespace g3r
