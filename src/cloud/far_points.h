// Points so far from the others that one frame cannot hold both.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Marks of the N points that make the others coincide: in a frame that holds both, double precision would round these by more than a
/// ten-thousandth of their spacing. That takes a distance of 2e10 of their sizes from 2,000 points. The others are the half of the distinct
/// finite points that is nearest to their middle (the median of each coordinate), and what is not so far from it. Empty where there is
/// none, as in every cloud that was measured. Does not depend on the order of the points. O(N), O(N log N) where there are some.
[[nodiscard]] std::vector<std::uint8_t> far_points(const PointsView& points);

}  // namespace g3r
