// The arcs of a dual surface: the lines across the faces of an octree along which its patches meet, and what they join.
//
// Round the rim of a face the signs change an even number of times, so arcs that do not cross join its crossings in pairs: steps 1 and 2 of
// the proof in docs/math.md.
#pragma once

#include "base/disjoint_sets.h"
#include "mesh/field_contour.h"
#include "mesh/field_octree.h"

#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// A minimal edge whose ends lie on different sides.
struct CrossingEdge : MinimalEdge {
  bool inside_low = false;
};

/// Where an edge meets the leaves around it: place kQuadrants e + k is that of the k-th leaf around edge e. If this leaf and the next one
/// around the edge are different, they share a face with the edge on its rim, and the place is that of the crossing on this face too.
constexpr std::uint32_t place_of(std::uint32_t edge, std::uint32_t k) { return kQuadrants * edge + k; }
constexpr std::uint32_t edge_of(std::uint32_t place) { return place / kQuadrants; }
constexpr std::uint32_t turn_of(std::uint32_t place) { return place % kQuadrants; }
/// The next place around the same edge.
constexpr std::uint32_t next_place(std::uint32_t place) { return place_of(edge_of(place), (turn_of(place) + 1) % kQuadrants); }
[[nodiscard]] inline std::uint32_t leaf_at(const std::vector<CrossingEdge>& edges, std::uint32_t place) {
  return edges[edge_of(place)].leaf[turn_of(place)];
}

struct Arc {
  std::uint64_t face = 0;          ///< unordered_pair_key() of the two leaves, which share at most one face
  std::uint32_t from = 0, to = 0;  ///< the places of its ends on this face
};

struct Arcs {
  DisjointSets places;        ///< those of one patch are together
  std::vector<Arc> multiple;  ///< the arcs of faces with more than one, face by face
};

/// `complete(leaf)`: whether `edges` has all crossings on the boundary of the leaf; faces between two that are not complete have no arcs.
/// Faces with more than one arc: if centre_inside(their centre), the runs of outside corners are cut off, and else those of inside ones.
/// O(edges log edges). Throws std::bad_alloc where the surface would have more vertices than 32 bits can count.
[[nodiscard]] Arcs join_arcs(const Octree& octree, const std::vector<CrossingEdge>& edges, const LeafTest& complete,
                             const InsideTest& centre_inside);

}  // namespace g3r::mesh
