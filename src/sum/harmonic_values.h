// What the right side of Green's identity is summed from (solve/harmonics.h).
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <vector>

namespace g3r {

/// Values and gradients of a set of harmonics at many points.
struct HarmonicValues {
  std::size_t count = 0;       ///< K
  std::vector<double> value;   ///< N x K, row-major
  std::vector<Vec3> gradient;  ///< N x K, row-major
};

}  // namespace g3r
