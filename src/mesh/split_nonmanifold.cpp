// Around an edge with 2 m triangles of both directions, solid and empty wedges alternate. The two triangles of each solid wedge become
// a pair with a midpoint of its own, which makes m edges out of one. After that every edge has two triangles, and vertices with several
// fans get one copy for each fan. Compare Gueziec, Taubin, Lazarus, Horn, "Cutting and stitching: converting sets of polygons to manifold
// surfaces", IEEE TVCG 7(2), 2001.
#include "mesh/split_nonmanifold.h"

#include "base/disjoint_sets.h"
#include "base/vector.h"
#include "cpu/parallel_sort.h"
#include "mesh/constants.h"
#include "mesh/half_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace g3r {

namespace {

using mesh::kNone;

/// Removes triangles that name a vertex twice, and pairs of triangles on the same vertices that face each other: they bound nothing.
void remove_folded(Mesh& mesh) {
  struct Entry {
    std::array<std::uint32_t, 3> vertices;  // ascending
    bool even;                              // whether the triangle runs that way round
    std::size_t triangle;
  };
  std::erase_if(mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  std::vector<Entry> entries;
  entries.reserve(mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    auto t = mesh.triangles[f];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    const bool even = t[1] < t[2];
    if (!even) std::swap(t[1], t[2]);
    entries.push_back({t, even, f});
  }
  parallel::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.triangle < b.triangle;
  });
  std::vector<std::size_t> unmatched;  // entries on the same vertices, all of one direction
  std::vector<char> folded(mesh.triangles.size(), 0);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!unmatched.empty() && entries[unmatched.back()].vertices != entries[i].vertices) unmatched.clear();
    if (unmatched.empty() || entries[unmatched.back()].even == entries[i].even) {
      unmatched.push_back(i);
    } else {
      folded[entries[i].triangle] = folded[entries[unmatched.back()].triangle] = 1;
      unmatched.pop_back();
    }
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (folded[f] == 0) mesh.triangles[kept++] = mesh.triangles[f];
  }
  mesh.triangles.resize(kept);
}

/// Appends a vertex between two others (or a copy, if they are the same).
std::uint32_t append_midpoint(Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  mesh.vertices.push_back(vector::scale(vector::add(mesh.vertices[a], mesh.vertices[b]), 0.5));
  if (!mesh.colors.empty()) {
    std::array<std::uint8_t, 3> color{};
    for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<std::uint8_t>((mesh.colors[a][k] + mesh.colors[b][k]) / 2);
    mesh.colors.push_back(color);
  }
  if (!mesh.confidence.empty()) mesh.confidence.push_back((mesh.confidence[a] + mesh.confidence[b]) / 2);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

/// A triangle at an edge: its half-edge, and the direction in which it leaves the edge.
struct Leaf {
  double angle;  ///< counter-clockwise, seen against the direction from low to high
  bool opens;    ///< solid begins here, in the sense of rising angle
  std::size_t corner;
};

/// The half-edges of one edge by angle.
std::vector<Leaf> leaves_around(const Mesh& mesh, const HalfEdge* half_edges, std::size_t count) {
  const Vec3 origin = mesh.vertices[half_edges[0].low];
  const Vec3 along = vector::normalised(vector::subtract(mesh.vertices[half_edges[0].high], origin));
  const Vec3 helper = std::fabs(along[0]) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x = vector::normalised(vector::cross(helper, along));
  const Vec3 y = vector::cross(along, x);
  std::vector<Leaf> leaves;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t apex = vertex_of(mesh, next_corner(next_corner(half_edges[i].corner)));
    const Vec3 to_apex = vector::subtract(mesh.vertices[apex], origin);
    // A triangle that runs from low to high faces rising angles: behind it, the solid ends.
    leaves.push_back(
        {std::atan2(vector::dot(to_apex, y), vector::dot(to_apex, x)), !is_forward(mesh, half_edges[i]), half_edges[i].corner});
  }
  std::sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) {
    if (a.angle != b.angle) return a.angle < b.angle;
    if (a.opens != b.opens) return a.opens;
    return a.corner < b.corner;
  });
  return leaves;
}

/// Pairs of half-edges that bound one solid wedge, by matching opening and closing leaves like parentheses around the circle.
std::vector<std::pair<std::size_t, std::size_t>> solid_wedges(std::vector<Leaf> leaves) {
  int open = 0, lowest = 0;
  std::size_t start = 0;  // after the lowest count no leaf closes what it did not see open
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    open += leaves[i].opens ? 1 : -1;
    if (open >= lowest) continue;
    lowest = open;
    start = i + 1;
  }
  std::rotate(leaves.begin(), leaves.begin() + static_cast<std::ptrdiff_t>(start % leaves.size()), leaves.end());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::vector<std::size_t> pending;
  for (const Leaf& leaf : leaves) {
    if (leaf.opens) {
      pending.push_back(leaf.corner);
    } else {
      pairs.emplace_back(pending.back(), leaf.corner);
      pending.pop_back();
    }
  }
  return pairs;
}

/// Appends triangle t, whose edges 01, 12, 20 are cut at the vertices `cut` (kNone: not cut), in one to four parts.
void append_cut(std::array<std::uint32_t, 3> t, std::array<std::uint32_t, 3> cut, std::vector<std::array<std::uint32_t, 3>>& out) {
  const auto cuts = std::count_if(cut.begin(), cut.end(), [](std::uint32_t c) { return c != kNone; });
  if (cuts == 0) {
    out.push_back(t);
    return;
  }
  if (cuts == 3) {
    out.insert(out.end(), {{t[0], cut[0], cut[2]}, {t[1], cut[1], cut[0]}, {t[2], cut[2], cut[1]}, {cut[0], cut[1], cut[2]}});
    return;
  }
  // Turned so that edge 01 is cut and, of two cuts, the other is in edge 12.
  while (cut[0] == kNone || (cuts == 2 && cut[1] == kNone)) {
    std::rotate(t.begin(), t.begin() + 1, t.end());
    std::rotate(cut.begin(), cut.begin() + 1, cut.end());
  }
  if (cuts == 1) {
    out.insert(out.end(), {{t[0], cut[0], t[2]}, {cut[0], t[1], t[2]}});
  } else {
    out.insert(out.end(), {{cut[0], t[1], cut[1]}, {t[0], cut[0], cut[1]}, {t[0], cut[1], t[2]}});
  }
}

/// Gives each solid wedge at an edge with more than two triangles a midpoint of its own.
void split_edges(Mesh& mesh) {
  std::vector<std::uint32_t> cut;  // per corner: the vertex that cuts the half-edge beginning there
  for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t count) {
    const auto forward =
        std::count_if(half_edges, half_edges + count, [&](const HalfEdge& half_edge) { return is_forward(mesh, half_edge); });
    if (count <= 2 || 2 * static_cast<std::size_t>(forward) != count) return;
    cut.resize(3 * mesh.triangles.size(), kNone);
    for (const auto& [a, b] : solid_wedges(leaves_around(mesh, half_edges, count))) {
      cut[a] = cut[b] = append_midpoint(mesh, half_edges[0].low, half_edges[0].high);
    }
  });
  if (cut.empty()) return;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    append_cut(mesh.triangles[f], {cut[3 * f], cut[3 * f + 1], cut[3 * f + 2]}, triangles);
  mesh.triangles = std::move(triangles);
}

/// Gives each fan of triangles around a vertex a vertex of its own; the first keeps the old one.
void split_vertices(Mesh& mesh) {
  DisjointSets corners = fans_of(mesh);
  std::vector<char> taken(mesh.vertices.size(), 0);
  for (std::size_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
    std::uint32_t& vertex = mesh.triangles[corner / 3][corner % 3];
    const std::size_t fan = corners.find(corner);
    if (fan != corner) {
      vertex = vertex_of(mesh, fan);  // the first corner of a fan comes before the others
    } else if (taken[vertex] == 0) {
      taken[vertex] = 1;
    } else {
      vertex = append_midpoint(mesh, vertex, vertex);
    }
  }
}

}  // namespace

Mesh split_nonmanifold(Mesh mesh) {
  remove_folded(mesh);
  split_edges(mesh);
  split_vertices(mesh);
  return mesh;
}

}  // namespace g3r
