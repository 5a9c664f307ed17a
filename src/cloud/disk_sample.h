// Points an even distance apart.
#pragma once

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// A maximal Poisson disk sample: takes the points in their order as long as they are `distance` (above 0) or more away from all taken
/// before, so that every point is nearer than that to one of the sample. O(N), fast in canonical order.
[[nodiscard]] std::vector<Vec3> disk_sample(const std::vector<Vec3>& points, double distance);

}  // namespace g3r
