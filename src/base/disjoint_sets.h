// Union-find.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <numeric>
#include <vector>

namespace g3r {

/// Disjoint sets of 0..n-1, with path halving, fewer than 2^32. The representative of a set is its smallest member. 4 bytes an element.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(checked(n)), count_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }

  [[nodiscard]] std::size_t find(std::size_t i) {
    auto at = static_cast<std::uint32_t>(i);
    while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
    return at;
  }
  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    if (i == j) return;
    parent_[std::max(i, j)] = static_cast<std::uint32_t>(std::min(i, j));
    --count_;
  }
  /// A further element, in a set of its own.
  std::size_t add() {
    parent_.push_back(static_cast<std::uint32_t>(checked(parent_.size() + 1) - 1));
    ++count_;
    return parent_.size() - 1;
  }
  /// Number of elements.
  [[nodiscard]] std::size_t size() const { return parent_.size(); }
  /// Number of sets.
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  static std::size_t checked(std::size_t n) {
    if (n > std::numeric_limits<std::uint32_t>::max()) throw std::bad_alloc();
    return n;
  }

  std::vector<std::uint32_t> parent_;
  std::size_t count_;
};

}  // namespace g3r
