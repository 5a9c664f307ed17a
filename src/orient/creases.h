// Normals at the creases of piecewise smooth shapes.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// The winding gradient is a mean over about a spacing, so it rounds the normals at creases. Where the 16 nearest points' normals differ
/// by more than 26 degrees, n_i becomes the mean of those whose tangent planes hold the point,
///   n_i <- normalised sum_j w_ij n_j over n_i . n_j > 0,
///   w_ij = exp(-(n_j . (p_i - p_j))^2 / 2 (0.05 h_i)^2) exp(-|p_i - p_j|^2 / 2 (1.5 h_i)^2),
/// twice: on a facet the planes of its points do, those beyond the crease do not. Each round turns a normal by less than 90 degrees.
/// True of CAD models, not of rough or finely detailed surfaces, so the cloud decides: the result is taken when afterwards, at such points
/// that are wanted, the median share of the weight that planes leave, sum w_ij / sum exp(-|p_i - p_j|^2 / ...), is at least 0.58 (measured
/// after fit_jets() at 50,000 points: CAD models 0.59 to 0.71, others at most 0.56). Returns whether it was. The idea of weights by tangent
/// planes: Oztireli, Guennebaud, Gross, "Feature preserving point set surfaces based on non-linear kernel regression", Eurographics 2009.
/// docs/evidence/directions.md.
/// h_i: smoothed_spacing(); `normals`: N unit vectors, consistent sides; `wanted`: N, or empty for all. O(N).
bool sharpen_creases(const PointSet& set, std::vector<Vec3>& normals, const std::vector<std::uint8_t>& wanted = {});

}  // namespace g3r
