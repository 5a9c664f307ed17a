// Other labellings of the ambiguous corners of an octree, where these leave fewer handles.
#pragma once

#include "mesh/field_contour.h"
#include "mesh/handle_removal.h"
#include "mesh/side_smoothing.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r::mesh {

/// What handles may cost.
struct HandlePrice {
  std::function<bool(std::uint32_t)> may_change;  ///< whether an ambiguous corner may
  HeldTest held;                                  ///< of HandleRemoval
  double most_per_handle = 0;                     ///< corners that change, at most, for each handle that goes: of HandleRemoval
};

/// Changes the signs of ambiguous corners, those in groups that lose handles by it or false joins of components, to the signs after some
/// smoothing (smooth_sides()) above some value; then of single ones. `inside`: one byte for each corner, in and out; if nothing would be
/// left inside all stays as it was. Throws Cancelled.
void remove_handles(const Octree& octree, const AmbiguousCorners& ambiguous, const HandlePrice& price, const InsideTest& centre_inside,
                    std::vector<std::uint8_t>& inside, const std::atomic<bool>* cancel);

}  // namespace g3r::mesh
