// The edges of an octree around the corners whose signs are open.
#pragma once

#include "mesh/field_contour.h"
#include "mesh/field_octree.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace g3r::mesh {

/// Numbers of edges, those of item i at begin[i] to begin[i + 1].
struct EdgeLists {
  std::vector<std::uint32_t> begin, edges;
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t i) const { return {edges.data() + begin[i], edges.data() + begin[i + 1]}; }
};

/// The part of an octree that open signs can change, which stays the same whatever they are.
struct OpenEdges {
  std::vector<std::uint32_t> corners;  ///< open ones, ascending
  std::vector<MinimalEdge> edges;      ///< around all leaves with an edge that ends at an open corner
  EdgeLists at_corner;                 ///< by place in corners
  EdgeLists around_leaf;               ///< of these leaves
  std::vector<std::uint8_t> around;    ///< 1 for these leaves
};

/// `open`: 1 for open corners. O(nodes + edges). Throws Cancelled.
[[nodiscard]] OpenEdges open_edges(const Octree& octree, const std::vector<std::uint8_t>& open, const std::atomic<bool>* cancel);

}  // namespace g3r::mesh
