// A tree in parts that a sum works on one after the other, so that it holds what it needs of a node's own for one part at a time.
#pragma once

#include "tree/octree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Subtrees, as large as they may be, and the nodes above them. Every node is in one part.
struct TreeParts {
  std::vector<std::uint32_t> roots;    ///< of the subtrees, which are the first parts
  std::vector<std::uint32_t> above;    ///< the other nodes, ascending: parts of kNodesAbove each, the last of fewer
  std::vector<std::uint32_t> part_of;  ///< every node's
  std::vector<std::uint32_t> slot;     ///< number of a node among the nodes of its subtree or among those above, ascending

  [[nodiscard]] std::size_t size() const { return roots.size() + (above.size() + kNodesAbove - 1) / kNodesAbove; }

  static constexpr std::size_t kNodesAbove = 256;  ///< of a part: enough that share a matrix, few enough for many threads
};

/// Subtrees of at most `points` points, or of a single leaf. O(nodes).
[[nodiscard]] TreeParts cut_tree(const Octree& tree, std::size_t points);

/// Points of a subtree for a tree of so many: few enough for all threads to have some and for what a part takes to stay in a cache, enough
/// for its nodes to share matrices.
[[nodiscard]] std::size_t points_of_a_part(std::size_t points);

}  // namespace g3r
