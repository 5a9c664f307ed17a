// Sides that neighbouring sites agree on: hypotheses that need no equations.
#pragma once

#include "cloud/point_set.h"
#include "cloud/sites.h"
#include "orient/sign_graph.h"
#include "sum/sum_plan.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// Every pair of near sites once, from the 10 nearest of each, with the weight
///   w_ij = f_i f_j exp(-|d|^2 / (2 (1.5 r)^2)) (n_i . n_j - 2 (n_i . e)(n_j . e)),
/// n the axes of the sites, d = p_j - p_i, e = d / |d|, r the distance of the sites, where every point is one the mean spacing of the two,
/// f = 1 - flatness: two normals agree if one is the mirror image of the other across the plane between the points, as on every arc (Xie,
/// Wang, Hua, Qin, Kaufman, "Piecewise C1 continuous surface reconstruction of noisy point clouds via local implicit quadric regression",
/// IEEE Visualization 2003). Sites farther apart than 4 r have a gap between them, and are no pair. O(M).
[[nodiscard]] std::vector<SignEdge> adjacent_sites(const Sites& sites);

/// M mean directions of the normals of the N points of every site; its axis where these cancel. O(N).
[[nodiscard]] std::vector<Vec3> at_sites(const Sites& sites, const std::vector<Vec3>& normals);

/// How surely every site has the side of the rest of what it hangs together with: held_together(), of adjacent_sites(). `normals`: of the
/// sites. O(M log M).
[[nodiscard]] std::vector<Hold> held_by_neighbours(const Sites& sites, const std::vector<Vec3>& normals);

/// Normals of all N points, three times at most: on the finest scale and on two with sites twice as far apart each, as long as there are 30
/// sites,
///   1. signs of the axes by agreement of neighbours (agree_on_signs());
///   2. three times the direction of the winding gradient of what came out, two site spacings wide, which fills grooves narrower than the
///      sampling and turns single sites;
///   3. the sides of each scale, with the directions of the finest, from a narrower field: so that only sides differ.
/// `finest`: sites of the set. Throws Cancelled. O(N log N).
[[nodiscard]] std::vector<std::vector<Vec3>> sides_by_agreement(const PointSet& set, const Sites& finest, const SumPlan& sums,
                                                                const std::atomic<bool>* cancel);

/// Normals of all N points on the sides of N known directions: the axes of the sites on those of their points, and on from there as above,
/// on the scale of these sites alone. Throws Cancelled. O(N log N).
[[nodiscard]] std::vector<Vec3> sides_as_known(const PointSet& set, const Sites& sites, const std::vector<Vec3>& known, const SumPlan& sums,
                                               const std::atomic<bool>* cancel);

/// Normals of all points from the field of the given ones, four site spacings wide: so wide that it sees no grooves but what is around.
/// Throws Cancelled. O(N log N).
[[nodiscard]] std::vector<Vec3> seen_from_afar(const PointSet& set, const Sites& sites, const std::vector<Vec3>& normals,
                                               const SumPlan& sums, const std::atomic<bool>* cancel);

}  // namespace g3r
