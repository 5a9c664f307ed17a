// Whether single precision keeps shapes of some size and place.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace g3r {

/// Whether the steps of float at the largest coordinate of the box are at most 1e-5 of its longest side: larger ones show on the surface.
[[nodiscard]] inline bool suits_float(const vector::Box& box) {
  constexpr double kStepPerExtent = 1e-5;
  using Float = std::numeric_limits<float>;
  double largest = 0;
  for (std::size_t k = 0; k < 3; ++k) largest = std::max({largest, std::fabs(box.low[k]), std::fabs(box.high[k])});
  return largest * double{Float::epsilon()} <= kStepPerExtent * box.longest_side() && largest <= double{Float::max()};
}

}  // namespace g3r
