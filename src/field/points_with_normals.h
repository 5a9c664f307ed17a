// The caller's points that have normals.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <vector>

namespace g3r {

struct PointsWithNormals {
  std::vector<Vec3> points;    ///< in the order of the input, as are
  std::vector<Vec3> normals;   ///< unit ones
  std::size_t non_finite = 0;  ///< points left out for a coordinate,
  std::size_t undirected = 0;  ///< and others for a normal that is zero or not finite
  std::vector<Vec3> far;       ///< left out with their normals: far_points()
};

/// Of N points and N normals of any length. O(N), O(N log N) where there are far ones.
[[nodiscard]] PointsWithNormals with_normals(const PointsView& points, const PointsView& normals);

}  // namespace g3r
