// Points that belong to no surface.
#pragma once

#include "cloud/canonical_cloud.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Indices, ascending, of the points of which one of these holds:
///   - the local spacing is more than twice that of their 8 neighbours (geometric mean): alone near a surface;
///   - it is more than twice the typical one, and the 16 nearest points fill space: the smallest principal spread is more than 7 % of the
///     sum of all three (on a surface, however sparse, below 3 %), and no plane through the point holds most of them, as that of a sparse
///     surface does where strays are near: one of many outliers.
/// A density that changes smoothly, by whatever factor, is no reason. Never more than a third of the points: then the cloud is something
/// else, and none is returned. O(N).
/// `relative_spacing`: how many times as far apart the points of a cloud are that has been thinned, which is no reason either; or empty.
[[nodiscard]] std::vector<std::uint32_t> find_outliers(const PointSet& set, const std::vector<double>& relative_spacing = {});

/// Takes the points with these indices out of the cloud and returns them. point_of and multiplicity number them after those that stay, and
/// before those taken out earlier.
std::vector<Vec3> remove_points(CanonicalCloud& cloud, const std::vector<std::uint32_t>& indices);

}  // namespace g3r
