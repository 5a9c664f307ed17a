// How noisy a cloud is, from the cloud alone.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// Standard deviation of the points from their surface, estimated from plane fits to neighbourhoods of 12 to 32 points; 0 for a clean
/// cloud.
///   - Noise lifts the residual of every neighbourhood; curvature, creases and thin parts only that of some. So the flattest 2 % decide:
///     their 12-point residual below 0.02 h means clean, and so does one below 0.08 h where 16-point quadratic height fields, which
///     curvature does not lift, leave less than 0.022 h (measured: 28 clean models of 5,000 to 50,000 points are clean by this, noise of
///     0.04 h is found).
///   - Two sheets close together, and wires, also lift it everywhere, but there are neighbourhoods whose distances have two peaks: a 10 %
///     quantile of the kurtosis (24 neighbours) below 1.85 means sheets or wires (measured: those 1.1 to 1.8, noise 1.94 to 2.1).
///   - The size follows from the residual x h of 32 neighbours: sigma = 0.95 h x / (1 - x), fitted to known noise of 0.25 to 1 %. Near
///     walls 32 neighbours see both sides, so x is at most what the residual y h of 16 lets expect on a plane, 1.27 y / (1 - (y / 0.47)^8).
/// `neighbours` of these points; `spacing`: typical_spacing(). Same units as the points. Looks at about 2000 points, in O(log N) each.
[[nodiscard]] double estimate_noise(const std::vector<Vec3>& points, const Neighbours& neighbours, double spacing);

}  // namespace g3r
