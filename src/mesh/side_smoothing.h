// Which side the places near walls and gaps are on, as their neighbours along the patch see it.
#pragma once

#include "mesh/field_octree.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// What is known about the octree corners that could be on either side; all others stand.
struct AmbiguousCorners {
  std::vector<std::uint32_t> corner;       ///< ascending
  std::vector<float> value;                ///< in [-1, 1], positive inside; its size is how sure it is
  std::vector<std::array<float, 3>> axis;  ///< unit normal of the nearest patch, either way round

  void add(std::uint32_t c, float its_value, const std::array<float, 3>& its_axis) {
    corner.push_back(c);
    value.push_back(its_value);
    axis.push_back(its_axis);
  }
};

/// Values averaged once, twice, ..., `times` times: each one with the values at the corners of its leaves that lie along the patch, so
/// that grain of the field goes and walls and gaps stay. `inside`: one byte per corner; those that stand count 1 inside, -1 outside.
/// The same values for any number of threads. O(leaves + times x ambiguous corners). Throws Cancelled.
[[nodiscard]] std::vector<std::vector<float>> smooth_sides(const Octree& octree, const AmbiguousCorners& ambiguous,
                                                           const std::vector<std::uint8_t>& inside, std::size_t times,
                                                           const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
