// What stands over other points of a scene.
#pragma once

#include <g3r/points.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r {

/// Marks (1) the points that lie over another surface. Both slope by up to 60 degrees: steeper ones lie over points of their own, and who
/// sees a wall need not stand below its eave. As seen along `up` (of length 1), with r the distance of the 12th nearest, one of these is
/// farther below than 2 tan(60 degrees) r, twice what such a slope goes down, and than 5 standard deviations `noise`, so that noise is no
/// second surface. `normals`: lines, N. Who has seen what is below may have seen such a point from below too. O(N log N). Throws Cancelled.
[[nodiscard]] std::vector<std::uint8_t> over_others(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const Vec3& up,
                                                    double noise, const std::atomic<bool>* cancel);

}  // namespace g3r
