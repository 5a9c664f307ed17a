// The edges of an octree around the corners whose signs are open.
#pragma once

#include "mesh/field_octree.h"

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace g3r::mesh {

/// Some of the leaves of an octree, numbered in their order. Two bits for each leaf of the octree.
class SomeLeaves {
 public:
  SomeLeaves() = default;
  /// `marked`: one byte per leaf of the octree.
  explicit SomeLeaves(const std::vector<std::uint8_t>& marked);

  [[nodiscard]] bool contains(std::uint32_t leaf) const { return (words_[leaf / kBits].marked >> leaf % kBits & 1U) != 0; }
  /// Of a leaf that is one of them.
  [[nodiscard]] std::uint32_t number(std::uint32_t leaf) const {
    const Word& word = words_[leaf / kBits];
    return word.before + static_cast<std::uint32_t>(std::popcount(word.marked & ((std::uint64_t{1} << leaf % kBits) - 1)));
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  static constexpr std::uint32_t kBits = std::numeric_limits<std::uint64_t>::digits;
  struct Word {
    std::uint64_t marked = 0;
    std::uint32_t before = 0;  // how many of the leaves come before these
  };
  std::vector<Word> words_;
  std::size_t count_ = 0;
};

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
  SomeLeaves around;                   ///< these leaves
  EdgeLists around_leaf;               ///< by their numbers
};

/// The leaves with an edge that ends at an open corner. `open`: 1 for open corners. O(nodes). Throws Cancelled.
[[nodiscard]] SomeLeaves leaves_around(const Octree& octree, const std::vector<std::uint8_t>& open, const std::atomic<bool>* cancel);

/// `around`: these leaves. O(nodes + edges). Throws Cancelled.
[[nodiscard]] OpenEdges open_edges(const Octree& octree, const std::vector<std::uint8_t>& open, SomeLeaves around,
                                   const std::atomic<bool>* cancel);

}  // namespace g3r::mesh
