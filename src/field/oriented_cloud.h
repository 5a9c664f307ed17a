// Points with area vectors in canonical order: what fields and meshers start from.
#pragma once

#include "cloud/canonical_cloud.h"

#include <g3r/points.h>

#include <cstddef>
#include <vector>

namespace g3r {

/// In the unit frame of `cloud`.
struct OrientedCloud {
  CanonicalCloud cloud;
  std::vector<Vec3> eta;       ///< M area-weighted normals in normalised units; duplicates are added up
  double spacing = 0;          ///< typical, normalised units
  std::size_t undirected = 0;  ///< points that are left out, as the normals at their place cancel
};

/// From N points, N unit normals and N areas in squared input units. Points without area are left out, and those whose area or normal is
/// not finite. `spacing`: the typical one in input units where it is known; with 0 it is found. Throws InvalidInput like canonical_cloud(),
/// and where no point has an area. O(N log N).
[[nodiscard]] OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                                           double spacing = 0);
/// The same with areas from the spacing of the points: area_vectors(). Duplicates share theirs, and their mean normal. Places where that is
/// 0 are left out: no normal of theirs is the right one.
[[nodiscard]] OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals);

}  // namespace g3r
