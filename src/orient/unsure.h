// The parts of a cloud in which sides are unsure.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// The unsure points and those around them, ascending: within 5 spacings of one. What more steps change there does not reach farther.
/// `spacing`: of every point, or one for all. O(N log N).
[[nodiscard]] std::vector<std::uint32_t> around_unsure(const std::vector<Vec3>& points, const std::vector<double>& spacing,
                                                       const std::vector<std::uint8_t>& unsure);

}  // namespace g3r
