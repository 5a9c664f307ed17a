// Points that belong to no surface.
#pragma once

#include "cloud/canonical_cloud.h"

#include <g3r/points.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace g3r {

/// What find_outliers() finds.
struct Outliers {
  std::vector<std::uint32_t> indices;  ///< ascending
  std::optional<double> noise;         ///< that of the other points, where it is known
  PointSet others;                     ///< the points without them, where those have been looked at already; else none
};

/// The points that are not on a surface:
///   - no slab through the point holds more of its 16, 32 or 64 nearest than chance would put there if they filled space: one in fifty
///     of those that do has such a slab. Only neighbours count that have it among as many nearest as well: all of a surface's, none of a
///     dense patch beside it;
///   - and its spacing is more than chance explains: of as many points as are taken, one in fifty are as far apart on an even surface.
///     That is from 1.5 typical spacings on among many outliers, from 2 on where there is one.
/// Noise scatters points as well, as far apart as outliers. So where a ball of 5 standard deviations holds more than 8 points of the noisy
/// layer, spacings are measured over as many, and chance moves points from its middle too; and none is taken about which a ball of 10
/// deviations has so many in one of 5 as no points that fill space do but for one in fifty, which says so of sparse layers too. `noise`: if
/// known; otherwise that of the other points, found in turn with the outliers. A density that changes smoothly is no reason. Never more
/// than half of the points: then the cloud is something else, and none is returned; nor of 64 points or fewer. O(N log N).
/// `relative_spacing`: how many times as far apart the points of a cloud are that has been thinned, which is no reason either; or empty.
[[nodiscard]] Outliers find_outliers(const PointSet& set, const std::vector<double>& relative_spacing = {},
                                     std::optional<double> noise = std::nullopt);

/// The share of some points of a set, at least one, that no slab as above holds: of those that fill space nearly all, of a surface hardly
/// any, but under noise; 0 in a set of 64 points or fewer. Looks at about 2000 of them, in O(log N) each.
[[nodiscard]] double share_in_space(const PointSet& set, const std::vector<std::uint32_t>& some);

/// Takes the points with these indices (ascending) out of the cloud and returns them. point_of and multiplicity number them after those
/// that stay, and before those taken out earlier. `others`: Outliers::others, whose neighbours are then known. O(N).
std::vector<Vec3> remove_points(CanonicalCloud& cloud, const std::vector<std::uint32_t>& indices, const PointSet& others = {});

}  // namespace g3r
