// Parts of a cloud that are no surface, however they are joined to it by what closes the mesh.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Marks (1) the points of parts that stay, by the law of kept_components(). Two points are of one part if one is among the 8 nearest of
/// the other and neither is twice as sparse as the other. A part goes if it has fewer points than least_points_of_a_part(strays), or than
/// strays are beside it; or if it has 192 points or more and most of them are on no slab (share_in_space()) while nine tenths of the
/// largest part are; the one with the most points stays. `strays`: points that no surface goes through, none of them among the points. O(N
/// log N).
[[nodiscard]] std::vector<std::uint8_t> points_of_parts(const PointSet& set, const std::vector<Vec3>& strays);

}  // namespace g3r::mesh
