// Which side the places near walls and gaps are on, as their neighbours along the sheet see it.
#pragma once

#include "mesh/field_octree.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// What is known about the octree corners that could be on either side; all others stand.
struct Opinions {
  std::vector<std::uint32_t> corner;       ///< ascending
  std::vector<float> side;                 ///< in [-1, 1], positive inside; its size is how sure it is
  std::vector<std::array<float, 3>> axis;  ///< unit normal of the nearest sheet, either way round

  void add(std::uint32_t c, float its_side, const std::array<float, 3>& its_axis) {
    corner.push_back(c);
    side.push_back(its_side);
    axis.push_back(its_axis);
  }
};

/// Opinions averaged once, twice, ..., `times` times: each one with the values at the corners of its leaves that lie along the sheet, so
/// that grain of the field goes and walls and gaps stay. `inside`: one byte per corner; those that stand count 1 inside, -1 outside.
/// The same values for any number of threads. O(leaves + times x opinions). Throws Cancelled.
[[nodiscard]] std::vector<std::vector<float>> smooth_sides(const Octree& octree, const Opinions& opinions,
                                                           const std::vector<std::uint8_t>& inside, std::size_t times,
                                                           const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
