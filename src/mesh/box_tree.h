// Pairs of boxes that meet, through a tree of boxes that is joined with itself.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace g3r::mesh {

/// An axis-parallel box. Single precision is enough to find candidates if every box is rounded outward.
struct FloatBox {
  std::array<float, 3> low{kFar, kFar, kFar};
  std::array<float, 3> high{-kFar, -kFar, -kFar};

  void extend(const FloatBox& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::max();
};

/// Whether two closed boxes have a point in common.
inline bool meet(const FloatBox& a, const FloatBox& b) {
  bool apart = false;
  for (std::size_t k = 0; k < 3; ++k) apart |= a.high[k] < b.low[k] || b.high[k] < a.low[k];
  return !apart;
}

/// All boxes are halved at the median along the longest side again and again, into equal parts, so a node's number says which boxes are its
/// own and nothing but its box is stored. About 40 bytes a box. Fewer than 2^31 boxes, finite.
class BoxTree {
 public:
  /// O(n log n), on all threads.
  explicit BoxTree(std::vector<FloatBox> boxes);

  /// All pairs of boxes that meet, as jobs that can be done at the same time: visit_pairs(job, visit) calls visit(first, second),
  /// first < second their places among the boxes, for the pairs of one job. O(n log n) if few boxes meet many.
  struct PairJob {
    std::uint32_t a, b;  ///< nodes
  };
  [[nodiscard]] std::vector<PairJob> pair_jobs() const;
  template <class Visit>
  void visit_pairs(const PairJob& job, const Visit& visit) const {
    if (is_leaf(job.a) && is_leaf(job.b)) return visit_leaves(job.a, job.b, visit);
    for_each_part(job, [&](const PairJob& part) { visit_pairs(part, visit); });
  }

 private:
  static constexpr std::size_t kLeafSize = 6;  // boxes in a leaf, at most

  // Node 0 is the root, 2 i + 1 and 2 i + 2 are the children of node i; the leaves are those of the last level.
  static int level_of(std::uint32_t node) { return static_cast<int>(std::bit_width(node + 1)) - 1; }
  [[nodiscard]] bool is_leaf(std::uint32_t node) const { return level_of(node) == levels_; }
  // The k-th node of a level has the boxes from begin(level, k) to begin(level, k + 1).
  [[nodiscard]] std::size_t begin(int level, std::size_t k) const {
    return static_cast<std::size_t>((std::uint64_t{order_.size()} * k) >> static_cast<unsigned>(level));
  }

  // The pairs of children of a job's nodes whose boxes meet.
  template <class Use>
  void for_each_part(const PairJob& job, const Use& use) const {
    const auto [a, b] = job;
    if (a == b) {
      use({2 * a + 1, 2 * a + 1});
      use({2 * a + 2, 2 * a + 2});
      if (meet(nodes_[2 * a + 1], nodes_[2 * a + 2])) use({2 * a + 1, 2 * a + 2});
      return;
    }
    const bool first = level_of(a) <= level_of(b);
    const std::uint32_t split = first ? a : b, other = first ? b : a;
    for (const std::uint32_t child : {2 * split + 1, 2 * split + 2}) {
      if (meet(nodes_[child], nodes_[other])) use({child, other});
    }
  }

  template <class Visit>
  void visit_leaves(std::uint32_t a, std::uint32_t b, const Visit& visit) const {
    const std::uint32_t first = (std::uint32_t{1} << static_cast<unsigned>(levels_)) - 1;
    const std::size_t a_end = begin(levels_, a - first + 1), b_begin = begin(levels_, b - first), b_end = begin(levels_, b - first + 1);
    for (std::size_t i = begin(levels_, a - first); i < a_end; ++i) {
      if (a != b && !meet(boxes_[i], nodes_[b])) continue;
      for (std::size_t j = a == b ? i + 1 : b_begin; j < b_end; ++j) {
        if (meet(boxes_[i], boxes_[j])) visit(std::min(order_[i], order_[j]), std::max(order_[i], order_[j]));
      }
    }
  }

  int levels_ = 0;
  std::vector<std::uint32_t> order_;  // of the boxes
  std::vector<FloatBox> boxes_;       // in this order
  std::vector<FloatBox> nodes_;
};

}  // namespace g3r::mesh
