// A plane through points.
#pragma once

#include "cloud/constants.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A plane and how well points lie in it.
struct PlaneFit {
  Vec3 normal{0, 0, 1};  ///< unit length, either side
  double residual = 0;   ///< root mean square distance in the unit of the points, corrected for kPlaneTerms
  double flatness = 0;   ///< least principal spread over the middle one: 0 for points in a plane, 1 for a ball
  double breadth = 0;    ///< middle principal spread over the largest one: 0 for points on a line
};

/// The least squares plane through points[index[0]], ..., points[index[count - 1]], count > kPlaneTerms. O(count).
[[nodiscard]] PlaneFit fit_plane(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count);

}  // namespace g3r
