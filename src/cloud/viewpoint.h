// Where a camera stood, from the lines of sight that its points lie on.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace g3r {

/// The place from which one camera has seen all points; nothing where none shows. However noisy its depths are, they move the points of a
/// row or a column of pixels in a plane through it. Two places are tried: `origin`, that of the coordinates of the points, in which depth
/// frames are given as a rule, and the one that most places of the cloud have in common of those where three exact planes
/// (find_exact_plane()) meet. It is where the camera stood if
///   - all points are in one half space before it: those seen all around it may be of a star-shaped body;
///   - the rows and columns of the points are in planes through it at one place in ten or more, and more often than by chance
///     (proving_number()). Where the points are on a facet or a step of depth, any straight row is in one, so that only rows that go on
///     beyond count. No two points are on one line of sight, as on those through the vanishing points of rounded depths;
///   - the angles between adjacent lines of sight are those of a grid: all but one in 50 from half to twice the median. Surfaces seen from
///     elsewhere, and rasters of terrain, have a twelfth or more outside;
///   - the same is not so of the opposite place: then the lines of sight are parallel, and say nothing of where they come from.
/// Nothing for fewer than 192 points. `origin` and the result: in the frame of the points. Looks at about 500 places, in O(log N) each: 5
/// ms, and O(N); O(N log N) where the first two are so.
[[nodiscard]] std::optional<Vec3> find_viewpoint(const PointSet& set, const Vec3& origin);

/// Whether one scanner at this place may have seen all these points: its lines of sight are as far apart as those around, all but one in 50
/// at least half as far as the median of the 8 nearest. Where what is in front hides nothing of what is behind, as about a solid, a sixth
/// are nearer. Not so for points that have been thinned at random. False for fewer than 192 points. O(N log N).
[[nodiscard]] bool may_be_seen_from(const std::vector<Vec3>& points, const Vec3& place);

/// The same of several: each at its place, of at least 192 points or none. `views`: known, of the N points and in their frame. O(N log N).
[[nodiscard]] bool may_be_seen(const std::vector<Vec3>& points, const Views& views);

/// Whether a plane through a point of the set holds the line of sight to it, from where PointSet::views() says, to the precision of exact
/// planes: those of rows of pixels do, a surface that is seen does not.
[[nodiscard]] bool is_along_sight(const PointSet& set, std::size_t point, const Vec3& normal);

}  // namespace g3r
