// Other labellings of the ambiguous corners of an octree, where these leave fewer handles.
#pragma once

#include "mesh/field_contour.h"
#include "mesh/side_smoothing.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r::mesh {

/// Of the ambiguous corners those change for which may_change(corner). `most_per_handle`: of HandleRemoval. Throws Cancelled.
void remove_handles(const Octree& octree, const AmbiguousCorners& ambiguous, const std::function<bool(std::uint32_t)>& may_change,
                    double most_per_handle, const InsideTest& centre_inside, std::vector<std::uint8_t>& inside,
                    const std::atomic<bool>* cancel);

}  // namespace g3r::mesh
