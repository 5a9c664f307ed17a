// Normals of the points of flat facets, up to their edges.
#pragma once

#include "cloud/point_set.h"
#include "orient/facets.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Points near an edge get blurred normals from all around them, or that of the wrong facet. What a facet (find_facets()) is, all of its
/// points say: n_i becomes the mean normal of the surfaces that p_i may be of, if noise of the facets' own deviation s has moved it there
/// (Bayes),
///   n_i <- normalised sum_f w_f n_f + mean of w_j n_j,
///   w_f = exp(-d_f^2 / 2 s^2) times the product over g of N(t_fg / s),   w_j = exp(-d_j^2 / 4 s^2) / sqrt(2).
/// f: facets of the 16 nearest points, d_f the distance from the plane; t_fg: how far inside f, along it, from where the plane of the other
/// facet g ends it, N the normal distribution; planes that have points of f on either side do not end it. j: those of the points that are
/// on no facet, with their tangent planes, which scatter as well. Points on no facet to within 2.5 s keep their normals, and so does what
/// is on the other side of a wall (n_f . n_i < -0.5). docs/math.md, "Facets".
/// s is kExactScatter h at least, h the typical spacing. `facets`: of these points; `wanted`: 1 for each whose normal may change, N, or
/// empty for all; `normals`: N unit vectors, consistent sides; n_f has that of most of these points. O(N).
void follow_facets(const PointSet& set, const Facets& facets, const std::vector<std::uint8_t>& wanted, std::vector<Vec3>& normals);

}  // namespace g3r
