// The half-edges of triangles, grouped by the edge that they share.
#pragma once

#include "base/disjoint_sets.h"
#include "cpu/parallel.h"
#include "mesh/counted_lists.h"

#include <g3r/mesh.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace g3r {

/// Corner 3 f + k is the k-th of triangle f.
inline std::uint32_t vertex_of(const Mesh& mesh, std::size_t corner) { return mesh.triangles[corner / 3][corner % 3]; }
inline std::size_t next_corner(std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/// The edge of a triangle from corner `corner` to the next corner; low <= high are its vertices.
struct HalfEdge {
  std::uint32_t low;
  std::uint32_t high;
  std::size_t corner;
};

/// Whether the triangle runs along this half-edge from its low to its high vertex.
inline bool is_forward(const Mesh& mesh, const HalfEdge& half_edge) { return vertex_of(mesh, half_edge.corner) == half_edge.low; }

/// The corner of the half-edge's triangle at v, one of the half-edge's two vertices.
inline std::size_t corner_at(const Mesh& mesh, const HalfEdge& half_edge, std::uint32_t v) {
  return vertex_of(mesh, half_edge.corner) == v ? half_edge.corner : next_corner(half_edge.corner);
}

/// Calls group(half_edges, count) once for every edge, with all half-edges between its two vertices, ordered by corner; edges come in the
/// order of (low, high). O(V + F) where few half-edges meet at a vertex.
template <class Group>
void for_each_edge(const Mesh& mesh, const Group& group) {
  const auto half_edge_at = [&](std::size_t corner) {
    const std::uint32_t from = vertex_of(mesh, corner), to = vertex_of(mesh, next_corner(corner));
    return HalfEdge{std::min(from, to), std::max(from, to), corner};
  };
  // By the lower vertex, then each vertex's few.
  std::vector<std::size_t> first;
  std::vector<HalfEdge> half_edges;
  const auto for_each_half_edge = [&](const auto& use) {
    for (std::size_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
      const HalfEdge half_edge = half_edge_at(corner);
      use(half_edge.low, half_edge);
    }
  };
  mesh::fill_lists(mesh.vertices.size(), for_each_half_edge, first, half_edges);
  parallel::for_blocks(mesh.vertices.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      std::sort(half_edges.begin() + static_cast<std::ptrdiff_t>(first[v]), half_edges.begin() + static_cast<std::ptrdiff_t>(first[v + 1]),
                [](const HalfEdge& a, const HalfEdge& b) { return a.high != b.high ? a.high < b.high : a.corner < b.corner; });
    }
  });
  for (std::size_t begin = 0; begin < half_edges.size();) {
    std::size_t end = begin + 1;
    while (end < half_edges.size() && half_edges[end].low == half_edges[begin].low && half_edges[end].high == half_edges[begin].high) ++end;
    group(half_edges.data() + begin, end - begin);
    begin = end;
  }
}

/// Joins the corners at an edge, of the same vertex and of triangles beside each other, so that all edges join the corners of each fan of
/// triangles about a vertex. `half_edges`: all `count` of the edge. `corners`: one for each corner.
inline void join_fans(const Mesh& mesh, const HalfEdge* half_edges, std::size_t count, DisjointSets& corners) {
  for (std::size_t i = 1; i < count; ++i) {
    for (const std::uint32_t v : {half_edges->low, half_edges->high})
      corners.join(corner_at(mesh, half_edges[0], v), corner_at(mesh, half_edges[i], v));
  }
}

/// The fans of triangles about the vertices, as sets of corners. O(V + F).
inline DisjointSets fans_of(const Mesh& mesh) {
  DisjointSets corners(3 * mesh.triangles.size());
  for_each_edge(mesh, [&](const HalfEdge* half_edges, std::size_t count) { join_fans(mesh, half_edges, count, corners); });
  return corners;
}

}  // namespace g3r
