// The dual traversal of two trees: which pairs of nodes are far, which pairs of leaves are near. Source: Dehnen 2002, with a symmetric
// splitting rule.
#pragma once

#include "tree/octree.h"

#include <cstdint>
#include <vector>

namespace g3r {

struct NodePair {
  std::uint32_t target;  ///< node of the target tree
  std::uint32_t source;  ///< node of the source tree
};

/// The pairs that one target subtree produced, in no order.
struct FoundPairs {
  std::vector<NodePair> far;
  std::vector<NodePair> near;
};

/// Decides pairs; far as build_interaction_lists() says. The trees must outlive it.
class Traversal {
 public:
  Traversal(const Octree& targets, const Octree& sources, double opening, double reach);
  /// Breadth first until the target side has enough subtrees: the open pairs by target subtree, which run() may take in parallel.
  std::vector<std::vector<NodePair>> start(FoundPairs& found) const;
  /// Decides open pairs and all that they are split into.
  void run(std::vector<NodePair> open_pairs, FoundPairs& found) const;

 private:
  bool open(const NodePair& pair, FoundPairs& found, std::vector<NodePair>& out) const;
  [[nodiscard]] bool far(const NodePair& pair, const OctreeNode& t, const OctreeNode& s) const;

  const Octree& targets_;
  const Octree& sources_;
  double opening_;
  double reach_;
  std::vector<Vec3> target_centres_;
  std::vector<Vec3> source_centres_;
};

}  // namespace g3r
