// Normals of flat facets from the points alone.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Points of a CAD model lie on its facets to rounding, and more of them on one plane than chance would put there prove it, however narrow
/// the facet and however close the wall behind it. So n_i becomes the normal, on its own side, of the plane through p_i that holds most of
/// its 32 nearest points, itself included: 8 or more to within 0.003 h_i, 7 to within 0.002 h_i or 6 to within 0.0005 h_i. Candidates are
/// the planes through p_i and two of the 10 nearest (every pair, as RANSAC would in the limit: Fischler and Bolles, "Random sample
/// consensus", Communications of the ACM 1981) that are less than 84 degrees off n_i; the best is fitted to what it holds. Points along a
/// line, which a curved surface has in planes across it, prove nothing: their second principal spread has to be 0.15 of the first.
/// Points with proven[i] != 0 keep their normals; those that get one are marked so. docs/study.md, "Planes". `spacing`: smoothed_spacing();
/// `normals`: N unit vectors. O(N log N), about 3 us a point that is not proven.
void fit_planes(const std::vector<Vec3>& points, const Neighbours& neighbours, const std::vector<double>& spacing,
                std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals);

}  // namespace g3r
