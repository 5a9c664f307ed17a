// Where a condition ends that holds up to a number and no further.
#pragma once

#include <limits>

namespace g3r {

/// The largest x >= 0 with holds(x), to rounding; holds(0), and there is a power of two from which on it does not.
template <typename Holds>
[[nodiscard]] double last_that(const Holds& holds) {
  double low = 0, high = 1;
  while (holds(high)) high *= 2;
  for (int bit = 0; bit < std::numeric_limits<double>::digits; ++bit) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace g3r
