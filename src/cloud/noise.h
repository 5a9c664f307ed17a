// How noisy a cloud is, from the cloud alone.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// Standard deviation of the points from their surface in each coordinate; 0 for a clean cloud.
///   - Noise lifts the residual of every neighbourhood; curvature, creases and thin parts only that of some. So the flattest 2 %
///     decide: their 12-point residual from a plane below 0.02 h means clean, and so does one from a quadratic height field, which
///     curvature does not lift, below 0.017 h, or below 0.04 h and 0.15 of the median (under noise it is 0.25 of that or more).
///   - Two layers close together, and wires, lift it everywhere, but there are neighbourhoods whose distances have two peaks: a 10 %
///     quantile of the kurtosis (24 neighbours) below 1.85 means layers or wires (measured: those 1.1 to 1.8, noise 1.94 to 2.1).
///   - Noise leaves no exact surface behind. Where 40 % of the points are on an exact plane (find_exact_plane(), breadth 0.4) and no
///     second one, a quarter of these planes within 60 degrees of that of 64 points (those of rasters and scan lines are not), or 0.5 % of
///     the neighbourhoods lie on two layers (fit_two_layers()) within 0.08 (16 points) or 0.12 (24) of their gap, the cloud is clean,
///     unless its coordinates are rounded to steps of 0.05 h or more, which puts noise on planes.
///   - The size is the less of two. While noise is small, from the residual x h of 32 neighbours:
///     sigma = h x / (0.842 - 0.372 x), x being at most what the residual y h of 16 lets expect on a plane, 1.27 y / (1 - (y / 0.47)^8):
///     32 neighbours reach across walls.
///   - And, of any size, layered_deviation() of 256 neighbours, its 10 % quantile: it distinguishes two or three layers from one, but needs
///     them to be smooth as far as that. Noise above h fills such neighbourhoods as well, so every fourth point is taken then, as often
///     as needed.
///   - Rounding of all three coordinates to steps q, as in voxels, counts as noise of the mean square of q_a^2 / 12 where that is above
///     0.04 h and the median residual of the height fields is half of it or more: rounded flat neighbourhoods may be exact. Coordinates of
///     less than 5 values are not rounded: they are those of a plate that stands straight.
/// Within about 15 % of the truth on smooth shapes from 0.2 to 3 h and on walls of 3 sigma (docs/evidence/noise.md). Same units as the
/// points. Looks at about 2000 points, in O(log N) each, and sorts the thinned clouds, O(N log N).
[[nodiscard]] double estimate_noise(const PointSet& set);

/// The noise where it is largest, if all scatter is noise: of scans that do not fit onto each other, or of noise that differs from place to
/// place, of which estimate_noise() finds the least. From the third quartile x h of the residuals of quadratic height fields through 12
/// points, as for even noise (measured within 15 % from 0.1 to 1.2 h):
///     sigma = h x / (1.12 sqrt(1 - (x / 0.64)^4)).
/// Walls and detail below the spacing lift it: not an estimate, but what to try. 0 for fewer than 200 points, or where exact planes as
/// above show that there is no noise. Units and cost as above.
[[nodiscard]] double largest_scatter(const PointSet& set);

/// Standard deviation of the points about the facets of a CAD model: what find_likeliest_plane() finds at most of about 500 points, where
/// 40 % of the 132 nearest points are on that plane too. A scanner scatters alike everywhere, detail does not, so two adjacent ones of its
/// steps have to hold 40 % of the points; else 0, and 0 for exact points. It sees a scatter too small to blur anything, for which
/// estimate_noise() is 0, and that of walls closer together than the sampling. 0 for fewer than 200 points. About 20 ms.
[[nodiscard]] double facet_scatter(const PointSet& set);

/// Along each axis, the step of which all coordinates are multiples, at least 0.05 typical spacings; 0 where there is none. Same units as
/// the points. O(N log N).
[[nodiscard]] Vec3 rounding_steps(const std::vector<Vec3>& points, double spacing);

/// How the number of points grows with the distance from one, as its power: about 2 on a surface, noisy or not, nearly 3 in a volume (2.6
/// to 3: its boundary counts). From the distances r of the neighbours k = min(2048, N / 16) and k / 8, ln 8 / ln(r_k / r_(k/8)), the median
/// over about 500 points; 2 for fewer than 200. O(k log N).
[[nodiscard]] double dimension(const PointSet& set);

}  // namespace g3r
