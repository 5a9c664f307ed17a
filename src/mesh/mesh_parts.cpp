#include "mesh/mesh_parts.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "mesh/constants.h"
#include "mesh/half_edges.h"
#include "mesh/triangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace g3r::mesh {
namespace {

template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> out;
  out.reserve(from.size());
  for (const std::uint32_t i : from) out.push_back(values[i]);
  values = std::move(out);
}

// Returns whether any triangle went.
bool keep_triangles(Mesh& mesh, const std::vector<std::uint8_t>& keep) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep[t] != 0) mesh.triangles[count++] = mesh.triangles[t];
  }
  if (count == mesh.triangles.size()) return false;
  mesh.triangles.resize(count);
  return true;
}

// Gives every fan of triangles around a vertex its own vertex: corner c of triangle t is number 3 t + c, and corners at one vertex
// belong together if their triangles share an edge at it.
void split_fans(Mesh& mesh, std::vector<std::uint32_t>& source) {
  DisjointSets corners = fans_of(mesh);
  std::vector<std::uint32_t> number(mesh.triangles.size() * 3, kNone);
  const std::vector<std::array<std::uint32_t, 3>> old = mesh.triangles;
  source.clear();
  for (std::uint32_t c = 0; c < number.size(); ++c) {
    const std::size_t root = corners.find(c);
    if (number[root] == kNone) {
      number[root] = static_cast<std::uint32_t>(source.size());
      source.push_back(old[c / 3][c % 3]);
    }
    mesh.triangles[c / 3][c % 3] = number[root];
  }
}

}  // namespace

void drop_unused_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNone), source;
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& v : t) {
      if (number[v] == kNone) {
        number[v] = static_cast<std::uint32_t>(source.size());
        source.push_back(v);
      }
      v = number[v];
    }
  }
  gather(mesh.vertices, source);
  gather(mesh.colors, source);
  gather(mesh.confidence, source);
}

void remove_triangles(Mesh& mesh, const std::vector<std::uint8_t>& keep) {
  if (!keep_triangles(mesh, keep)) return;
  std::vector<std::uint32_t> source;
  split_fans(mesh, source);
  gather(mesh.vertices, source);
  gather(mesh.colors, source);
  gather(mesh.confidence, source);
}

Components find_components(const Mesh& mesh) {
  DisjointSets groups(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    groups.join(t[0], t[1]);
    groups.join(t[0], t[2]);
  }
  Components components;
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNone);
  for (const auto& t : mesh.triangles) {
    std::uint32_t& n = number[groups.find(t[0])];
    if (n == kNone) n = static_cast<std::uint32_t>(components.count++);
    components.of.push_back(n);
  }
  return components;
}

Vec3 centre_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return vector::scale(vector::add(mesh.vertices[t[0]], vector::add(mesh.vertices[t[1]], mesh.vertices[t[2]])), 1.0 / 3);
}

std::vector<Vec3> centres_of(const Mesh& mesh) {
  std::vector<Vec3> centres;
  centres.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) centres.push_back(centre_of(mesh, t));
  return centres;
}

double area_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3 n = twice_area_vector(mesh.vertices, t);
  return 0.5 * std::hypot(n[0], n[1], n[2]);
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3{0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3 n = twice_area_vector(mesh.vertices, t);
    for (const std::uint32_t v : t) normals[v] = vector::add(normals[v], n);
  }
  for (Vec3& n : normals) n = vector::normalised(n);
  return normals;
}

void remove_components(Mesh& mesh, const Components& components, const std::vector<std::uint8_t>& keep) {
  std::vector<std::uint8_t> keep_triangle(mesh.triangles.size());
  for (std::size_t t = 0; t < keep_triangle.size(); ++t) keep_triangle[t] = keep[components.of[t]];
  if (keep_triangles(mesh, keep_triangle)) drop_unused_vertices(mesh);  // no vertex keeps some of its triangles only
}

}  // namespace g3r::mesh
