// From the canonical order and the unit frame back to the caller's points.
#pragma once

#include "cloud/canonical_cloud.h"
#include "orient/open_surfaces.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Writes the solution and its confidence to `out`, one value for each of the caller's N points, in their order. A duplicate gets the
/// normal and the confidence of its twin, and its share of the area; areas are in squared input units. Points that are not finite get
/// zeros. `solution`, `confidence`: of the points of the cloud and then of its outliers. O(N).
void to_callers_order(const CanonicalCloud& cloud, const Solution& solution, const std::vector<float>& confidence, Orientation& out);

/// Which of the caller's N points lie on open surfaces: 1 for those. O(N).
[[nodiscard]] std::vector<std::uint8_t> open_in_callers_order(const CanonicalCloud& cloud, const OpenSurfaces& surfaces);

}  // namespace g3r
