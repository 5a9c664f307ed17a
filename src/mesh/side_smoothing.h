// Which side the places near walls and gaps are on, as their neighbours along the sheet see it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/field_octree.h"

namespace g3r::mesh {

/// One opinion per octree corner.
struct Opinions {
  std::vector<double> side;                ///< in [-1, 1], positive inside; its size is how sure it is
  std::vector<std::uint8_t> open;          ///< 1: could be on either side, 0: stands
  std::vector<std::array<float, 3>> axis;  ///< of open corners: unit normal of the nearest sheet, either way round
};

/// Opinions averaged once, twice, ..., `times` times: at each open corner its opinion with the values at the corners of its leaves that lie
/// along the sheet, so that grain of the field goes and walls and gaps stay. The same values for any number of threads.
/// O(leaves + times x open corners). Throws Cancelled.
[[nodiscard]] std::vector<std::vector<double>> smooth_sides(const Octree& octree, const Opinions& opinions, std::size_t times,
                                                            const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
