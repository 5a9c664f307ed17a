// The sides of triangles, grouped by the edge that they share.
#pragma once

#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <g3r/mesh.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace g3r {

/// Corner 3 f + k is the k-th of triangle f.
inline std::uint32_t vertex_of(const Mesh& mesh, std::size_t corner) { return mesh.triangles[corner / 3][corner % 3]; }
inline std::size_t next_corner(std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/// The side of a triangle from corner `corner` to the next corner; low <= high are its vertices.
struct Side {
  std::uint32_t low;
  std::uint32_t high;
  std::size_t corner;
};

/// Whether the triangle runs along this side from its low to its high vertex.
inline bool is_forward(const Mesh& mesh, const Side& side) { return vertex_of(mesh, side.corner) == side.low; }

/// The corner of the side's triangle at v, one of the side's two vertices.
inline std::size_t corner_at(const Mesh& mesh, const Side& side, std::uint32_t v) {
  return vertex_of(mesh, side.corner) == v ? side.corner : next_corner(side.corner);
}

/// Calls group(sides, count) once for every edge, with all sides between its two vertices, ordered by corner; edges come in the order of
/// (low, high). O(V + F) where few sides meet at a vertex.
template <class Group>
void for_each_edge(const Mesh& mesh, const Group& group) {
  const auto side_at = [&](std::size_t corner) {
    const std::uint32_t from = vertex_of(mesh, corner), to = vertex_of(mesh, next_corner(corner));
    return Side{std::min(from, to), std::max(from, to), corner};
  };
  // By the lower vertex, then each vertex's few.
  const std::size_t corners = 3 * mesh.triangles.size();
  std::vector<std::size_t> first(mesh.vertices.size() + 2, 0);
  for (std::size_t corner = 0; corner < corners; ++corner) ++first[side_at(corner).low + 2];
  for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
  std::vector<Side> sides(corners);
  for (std::size_t corner = 0; corner < corners; ++corner) {
    const Side side = side_at(corner);
    sides[first[side.low + 1]++] = side;
  }
  parallel::for_blocks(mesh.vertices.size(), mesh::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      std::sort(sides.begin() + static_cast<std::ptrdiff_t>(first[v]), sides.begin() + static_cast<std::ptrdiff_t>(first[v + 1]),
                [](const Side& a, const Side& b) { return a.high != b.high ? a.high < b.high : a.corner < b.corner; });
    }
  });
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin + 1;
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high) ++end;
    group(sides.data() + begin, end - begin);
    begin = end;
  }
}

}  // namespace g3r
