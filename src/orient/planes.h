// Normals of flat facets from the points alone.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// n_i becomes the normal, on its own side, of the exact plane through p_i, where there is one (find_exact_plane() of the 33 nearest
/// points, towards n_i). Points with proven[i] != 0 keep their normals; those that get one are marked so. No plane is taken where those
/// that differ from n_i hold curves: then the points come from slices or scan lines, whose planes are no facets. docs/study.md, "Planes".
/// `spacing`: smoothed_spacing(); `normals`: N unit vectors. O(N log N), about 3 us a point that is not proven.
void fit_planes(const std::vector<Vec3>& points, const Neighbours& neighbours, const std::vector<double>& spacing,
                std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals);

}  // namespace g3r
