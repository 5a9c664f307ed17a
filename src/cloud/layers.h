// Points around several layers of surface, one above the other: how far from their own layer they are.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Standard deviation of points about parallel layers. The heights over a plane are taken for draws from a mixture of C Gaussians,
///     z ~ q(u, v) + sum_c share_c N(offset_c, sigma^2),     q a quadratic without constant,
/// fitted by expectation and maximisation (Dempster, Laird, Rubin 1977) for C = 1, 2, 3; the C with the smallest Bayesian information
/// criterion (Schwarz 1978) counts. So two sides of a wall 3 sigma thick are two layers, where the spread about one is 1.8 sigma.
/// `index`: `count` > 40 points around `centre`, nearest first; those less than 0.6 of the last one's distance away from the axis
/// through `centre` along `normal` take part. Same unit as the points; 0 where 8 or fewer do. O(count).
[[nodiscard]] double layered_deviation(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre,
                                       const Vec3& normal);

}  // namespace g3r
