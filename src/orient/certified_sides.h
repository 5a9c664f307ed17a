// How far the field shows the sides of points to be right.
#pragma once

#include "cloud/constants.h"
#include "cloud/point_set.h"
#include "orient/site_parts.h"
#include "sum/sum_plan.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// Mean unrest (Certificate::unrest) of a part that is open: closed ones have up to 0.06, open ones 0.1 to 0.3.
inline constexpr double kUnrest = 0.08;
/// The same of parts, of which sites may be thinned for noise (SiteParts::thinned_for_noise()): it hides thin walls, whose field is open in
/// places, so what is open has clearly more.
[[nodiscard]] constexpr double unrest_of_open(bool thinned_for_noise) { return thinned_for_noise ? kUnrest / kClearlyLess : kUnrest; }

/// Of every site, how far the normals of its points and of those of the 8 sites around it are one direction: the length of their mean (the
/// mean resultant length of directional statistics; Mardia and Jupp, "Directional Statistics", 2000), the mean cosine between them and it:
/// 1 where all are the same, near 0 where they face either way, as in two walls or patches closer together than the sites. `normals`: N.
/// O(N).
[[nodiscard]] std::vector<double> concentration(const Sites& sites, const std::vector<Vec3>& normals);

/// How far the certificate of the given normals shows the sides of the points to be right, N values in 0..1: J (1 - (u / U)^2), u the mean
/// unrest of their part, U at most, which is unrest_of_open(), as what is as restless as an open surface is not shown to be closed, and
/// nothing else says that its sides are right; J = max(0, jump of the site), 1 at most. Where walls are too close for the sampling the
/// field does not jump from 0 to 1, whatever the sides. J is the largest jump, and 1 - scaled_defect where sites are thinned for noise,
/// which makes layers of single wrong patches. Under noise (`exact` is false) it counts R times, R the concentration(): two walls closer
/// together than 4 sigma are one site or two neighbours, and which normal is whose is chance. Points that face the other way than the mean
/// of their site have 0, and so have those of exact parts of fewer than 30 sites (kFewestSites): such patches are not tested for being
/// open, and their fields jump as those of closed surfaces do. O(N).
[[nodiscard]] std::vector<float> certified_sides(const SiteParts& parts, const Certificate& certificate, const std::vector<Vec3>& normals,
                                                 bool exact);

/// The same of normals alone, for sides that have changed since: of 30 points and more; of fewer none is shown. `noise`: standard
/// deviation; 0: exact. O(N log N). Throws Cancelled.
[[nodiscard]] std::vector<float> certified_sides(const PointSet& set, double noise, const SumPlan& sums, const std::vector<Vec3>& normals,
                                                 const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
