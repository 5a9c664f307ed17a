// What a careful user should know of a cloud and its mesh: one line each, with what was seen, how much, and what to do.
#pragma once

#include "cloud/canonical_cloud.h"

#include <g3r/g3r.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r {

/// Warns of
///   - sampling in lines: where a quarter of the points lie along a curve with their 8 nearest;
///   - rounded coordinates: where surface across an axis is in terraces. Of the pairs of near points that face the same way along the axis,
///     5 to 90 % have exactly the same coordinate, and the others' differ by a step of 0.15 to 4 spacings. Not where half of these points
///     are at walls or gaps, as those of slats, nor where coordinates of other points are between the steps (rounding_steps()), as at the
///     rims of thin walls.
///   - two surfaces that cross (mesh/crossings.h): parts whose points were put together, or scans that do not fit.
/// `normals`: unit. O(N).
void warn_of_sampling(const CanonicalCloud& cloud, const std::vector<Vec3>& normals, Stats& stats);

/// Warns, and calls the result doubtful, where a closed mesh has 10 handles or parts or more and fewer than 150 points for each: surfaces
/// that are resolved have more.
void warn_of_topology(const MeshCheck& check, Stats& stats);

/// Warnings where more triangles are left than `faces` (0: no limit) asks for, as fewer would change what the surface is, and where pairs
/// of them intersect that did not when there were more.
void warn_of_faces(std::size_t triangles, std::size_t faces, std::size_t new_crossings, std::vector<std::string>& warnings);

}  // namespace g3r
