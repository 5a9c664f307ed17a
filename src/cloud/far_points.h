// Points so far from the others that one frame cannot hold both.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Marks of the N points that make the others coincide: in a frame that holds both, these would be less than kLeastSpacing apart, which is
/// what kernels resolve. That takes a distance of 40,000 of their sizes from 2,000 points. The others are the half of the distinct finite
/// points that is nearest to their middle (the point nearest to the median of each coordinate), and what is not so far from it. Empty where
/// there is none, and where fewer than kLeastPoints others would be left. Does not depend on the order of the points. O(N), O(N log N)
/// where there are some.
[[nodiscard]] std::vector<std::uint8_t> far_points(const PointsView& points);

}  // namespace g3r
