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
/// misfit and its degrees of freedom), p_i is within 2.5 of these of it (kExactScatter h_i at least), and n_i turns by less than 26
/// degrees; there the points prove it. Sides are kept. Returns 1 for the points with a fitted normal, 0 for the others.
/// docs/evidence/directions.md. `normals`: N unit vectors, consistent sides. O(N).
std::vector<std::uint8_t> fit_jets(const PointSet& set, std::vector<Vec3>& normals);

/// Beside a crease the nearest points are of several smooth surfaces, and n_i is a mean of theirs. So a point that is not proven is tried
/// on the surfaces of the 33 nearest proven points: for each direction n_j of theirs that is within 60 degrees of n_i, and 26 degrees from
/// those tried already, a jet is fitted as above to those of them whose normals are within 26 degrees of n_j. n_i becomes the normal at p_i
/// of the only one of these jets that is proven and holds p_i. Where none does, or several do, which is at the crease itself, n_i stays.
/// `proven`: N, 1 for the points whose normals are proven, by whatever. `normals`: N unit vectors, consistent sides. O(N log N).
void fit_jets_at_creases(const PointSet& set, const std::vector<std::uint8_t>& proven, std::vector<Vec3>& normals);

}  // namespace g3r
