// Union-find.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace g3r {

/// Disjoint sets of 0..n-1, with path halving. The representative of a set is its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n), count_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  [[nodiscard]] std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    if (i == j) return;
    parent_[std::max(i, j)] = std::min(i, j);
    --count_;
  }
  /// A further element, in a set of its own.
  std::size_t add() {
    parent_.push_back(parent_.size());
    ++count_;
    return parent_.size() - 1;
  }
  /// Number of elements.
  [[nodiscard]] std::size_t size() const { return parent_.size(); }
  /// Number of sets.
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<std::size_t> parent_;
  std::size_t count_;
};

}  // namespace g3r
