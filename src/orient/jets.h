// Normals of smooth regions from the points alone.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// A winding gradient is a sum over random samples, so it scatters by a few tenths of a degree even on a sphere. Where the surface is
/// smooth the points say more: n_i becomes the normal at p_i of the quadratic height field fitted to those of the 16 nearest points whose
/// normals are within 26 degrees of n_i and with weights exp(-|p_j - p_i|^2 / 2 (1.5 h_i)^2) (a 2-jet: Cazals and Pouget, "Estimating
/// differential quantities using polynomial fitting of osculating jets", Computer Aided Geometric Design 2005). Only where at least 6 of
/// them take part, the heights scatter about the field by at most 0.007 h_i, h_i the smoothed_spacing() (standard deviation, from the
/// misfit and its degrees of freedom) and n_i turns by less than 26 degrees; there the points prove it. Sides are kept. Returns 1 for the
/// points with a fitted normal, 0 for the others. docs/evidence/directions.md. `normals`: N unit vectors, consistent sides. O(N).
std::vector<std::uint8_t> fit_jets(const PointSet& set, std::vector<Vec3>& normals);

}  // namespace g3r
