// The median, for scales that a few extreme values must not move.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace g3r {

/// The upper median: the value of rank size / 2, counted from 0. `values` must not be empty. O(N).
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace g3r
