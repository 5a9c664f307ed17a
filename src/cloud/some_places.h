// Some of many things, evenly spread over their order, that stand for all of them.
#pragma once

#include <algorithm>
#include <cstddef>

namespace g3r {

/// Every so-many-th of `total` things, from the first on: the k-th of them is number some[k].
class SomePlaces {
 public:
  /// `wanted` (above 0) to twice as many of them; all of fewer.
  [[nodiscard]] static SomePlaces at_least(std::size_t wanted, std::size_t total) {
    return SomePlaces(total, std::max<std::size_t>(1, total / wanted));
  }
  /// `most` (above 0) or fewer, half as many at least; all of fewer.
  [[nodiscard]] static SomePlaces at_most(std::size_t most, std::size_t total) { return SomePlaces(total, 1 + total / most); }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t operator[](std::size_t k) const { return k * step_; }

 private:
  SomePlaces(std::size_t total, std::size_t step) : step_(step), size_((total + step - 1) / step) {}

  std::size_t step_;
  std::size_t size_;
};

}  // namespace g3r
