#include "mesh/edge_collapse.h"

#include "mesh/triangle.h"

#include <algorithm>
#include <iterator>

namespace g3r::mesh {

using vector::dot;
using vector::subtract;

EdgeCollapse::EdgeCollapse(Mesh& mesh)
    : mesh_(mesh),
      count_(mesh.triangles.size()),
      is_left_(mesh.triangles.size(), 1),
      on_boundary_(mesh.vertices.size(), 0),
      first_(mesh.vertices.size(), kNone),
      next_(3 * mesh.triangles.size(), kNone) {
  for (std::size_t corner = next_.size(); corner-- > 0;) {
    std::uint32_t& first = first_[mesh.triangles[corner / 3][corner % 3]];
    next_[corner] = first;
    first = static_cast<std::uint32_t>(corner);
  }
  for (std::uint32_t v = 0; v < first_.size(); ++v) {
    find_neighbours(v, ring_);
    if (std::any_of(ring_.begin(), ring_.end(), [&](std::uint32_t other) { return triangles_of(v, other) == 1; })) on_boundary_[v] = 1;
  }
}

double EdgeCollapse::squared_length(std::uint32_t a, std::uint32_t b) const {
  const Vec3 d = subtract(mesh_.vertices[a], mesh_.vertices[b]);
  return dot(d, d);
}

Vec3 EdgeCollapse::normal_of(const std::array<std::uint32_t, 3>& triangle, std::uint32_t from, std::uint32_t to) const {
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = mesh_.vertices[triangle[k] == from ? to : triangle[k]];
  return twice_area_vector(p[0], p[1], p[2]);
}

void EdgeCollapse::find_neighbours(std::uint32_t v, std::vector<std::uint32_t>& neighbours) const {
  neighbours.clear();
  for_triangles_of(v, [&](const std::array<std::uint32_t, 3>& t) {
    for (const std::uint32_t other : t) {
      if (other != v) neighbours.push_back(other);
    }
    return true;
  });
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
}

std::size_t EdgeCollapse::triangles_of(std::uint32_t a, std::uint32_t b) const {
  std::size_t count = 0;
  for_triangles_of(a, [&](const std::array<std::uint32_t, 3>& t) {
    count += std::find(t.begin(), t.end(), b) != t.end() ? 1 : 0;
    return true;
  });
  return count;
}

bool EdgeCollapse::is_boundary(std::uint32_t a, std::uint32_t b) const {
  return on_boundary_[a] != 0 && on_boundary_[b] != 0 && triangles_of(a, b) == 1;
}

// The ends have no neighbours in common but those of the triangles of the edge, and an edge between two boundaries is one of a boundary.
bool EdgeCollapse::keeps_topology(std::uint32_t from, std::uint32_t to) {
  find_neighbours(from, ring_);
  find_neighbours(to, other_);
  if (ring_.size() <= 3 && other_.size() <= 3) return false;  // a tetrahedron, or little more than a triangle
  common_.clear();
  std::set_intersection(ring_.begin(), ring_.end(), other_.begin(), other_.end(), std::back_inserter(common_));
  const std::size_t sides = triangles_of(from, to);
  if (common_.size() != sides || sides > 2) return false;
  return sides == 1 || on_boundary_[from] == 0 || on_boundary_[to] == 0;
}

bool EdgeCollapse::collapse(std::uint32_t from, std::uint32_t to) {
  if (!keeps_topology(from, to)) return false;
  for (std::uint32_t corner = first_[from]; corner != kNone; corner = next_[corner]) {
    if (is_left_[corner / 3] == 0) continue;
    auto& t = mesh_.triangles[corner / 3];
    if (std::find(t.begin(), t.end(), to) != t.end()) {
      is_left_[corner / 3] = 0;
      --count_;
    }
    t[corner % 3] = to;
  }
  std::uint32_t* last = &first_[to];  // the corners that are left, those of `from` after those of `to`
  for (const std::uint32_t first : {first_[to], first_[from]}) {
    for (std::uint32_t corner = first; corner != kNone; corner = next_[corner]) {
      if (is_left_[corner / 3] == 0) continue;
      *last = corner;
      last = &next_[corner];
    }
  }
  *last = kNone;
  first_[from] = kNone;
  on_boundary_[to] |= on_boundary_[from];
  return true;
}

}  // namespace g3r::mesh
