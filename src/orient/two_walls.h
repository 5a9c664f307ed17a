// Whether what looks like one surface is two walls, closer together than the field can distinguish.
#pragma once

#include "cloud/point_set.h"
#include "cloud/sites.h"

#include <cstdint>
#include <vector>

namespace g3r {

/// Looks at the points around 500 to 1000 of the given sites of one part (all of fewer), by two laws, of which either is enough:
///   - Walls that noise does not hide: n points on two walls, each with a label that costs ln 2, have the log likelihood
///     -n ln s2 - n ln 2, on one -n ln s1, with s the standard deviations from parallel quadratics less than 2 site spacings apart
///     (fit_two_layers()), and from one, through 24 points. Two are likelier if they are at half of the places or more. Rounding spreads
///     heights evenly, and what is cut in half then has half the deviation without any wall: another ln 2 per point against two.
///     Where such walls are why a field is restless, it is so on them. If it is no less restless in places on one wall, and by more than
///     kUnrest, they are not the reason, and count for nothing: scans of one open surface that overlap in part and do not fit onto each
///     other. Of 2000 to 4000 places those are on one wall, or on two, that are so themselves with their 8 nearest, all but one; fewer than
///     30 on one wall say nothing.
///   - Where there is noise, walls that it hides: MeanExcess::is_two_walls() of the heights over cubics through 132 points.
/// `members`: of the sites, at least one; `noise`: standard deviation, unit of the points; 0: none; `unrest`: Certificate::unrest of all
/// sites. O(log N) per place, and O(N log N) once for the steps of rounding.
[[nodiscard]] bool on_two_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members, double noise,
                                const std::vector<double>& unrest);

}  // namespace g3r
