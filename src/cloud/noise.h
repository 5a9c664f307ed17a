// How noisy a cloud is, from the cloud alone.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// Mean of the n-th power, n even, of what rounding to whole steps leaves, evenly between -1/2 and 1/2 of one: 1/12 and 1/80 of 2 and 4.
constexpr double rounding_moment(int n) { return 1.0 / ((n + 1) * (1 << n)); }
inline constexpr double kRoundingVariance = rounding_moment(2);
/// The fourth cumulant of the same, which that of a normal distribution is above by 1/120.
inline constexpr double kRoundingCumulant = rounding_moment(4) - 3 * kRoundingVariance * kRoundingVariance;

/// In spacings: noise below this counts as none, as it blurs nothing and curvature leaves as much.
inline constexpr double kLeastNoise = 0.04;

/// Standard deviation of the points from their surface in each coordinate; 0 for a clean cloud.
///   - Noise lifts the residual of every neighbourhood; curvature, creases and thin parts only that of some. So the flattest 2 % decide. Of
///     quadratic height fields through 12 points noise sigma leaves residuals of a chi distribution with 6 degrees of freedom, times a
///     scatter x h that is sigma while that is small, and fills the balls in the end: 1 / x^2 = (h / sigma)^2 + 1 / 0.57^2.
///   - Noise is as large in small neighbourhoods as in larger ones, shape is not. Where the flattest 2 % of 8 points scatter half as much
///     or less than the flattest 10 % of 12 points, that is shape: thin walls, wires, detail (measured: up to 0.48; noise 0.56 and more).
///   - Noise leaves no exact planes behind. Where a third of the points is on one (find_exact_plane(), breadth 0.5) and no second one, the
///     cloud is clean, unless its coordinates are rounded to steps of 0.04 h or more, which puts noise on planes. So is one of facets about
///     which points scatter less than 0.04 h (facet_scatter()): what lies farther from a height field is on another wall.
///   - Against two or three layers of a smooth surface there is layered_deviation() of 256 neighbours, its 10 % quantile; the lesser of the
///     two counts. It needs the layers to be smooth as far as that. Noise above h fills such neighbourhoods as well, so every fourth point
///     is taken then, as often as needed.
///   - Less than 0.04 h is none.
///   - Rounding leaves noise as well: rounding_noise().
/// Mostly within 10 %, always within 20 % of the truth on smooth shapes from 0.1 to 2 h and on walls of 3 sigma; at 3 h, which fill the
/// neighbourhoods of fewer points, 0.6 to 0.95 of it (docs/evidence/noise.md). Same units as the points. Looks at about 2000 points, in
/// O(log N) each, and sorts the thinned clouds, O(N log N).
[[nodiscard]] double estimate_noise(const PointSet& set);

/// The noise of a cloud for which that is less than 0.04 h, and so called none: kernels hide it, directions need not follow it. That of the
/// flattest 2 % of 12 points, up to sqrt(2) 0.04 h, as layers may show less; 0 where it is more, where the points are exact to 0.001 h or
/// a third of them on exact planes, and where shape explains as much: in the median place 24 points scatter at least sqrt(2) times as much
/// as 8. Units and cost as above.
[[nodiscard]] double fine_noise(const PointSet& set);

/// Standard deviation of what rounding all three coordinates to steps q leaves, as in voxels: the root of the mean of q_a^2 / 12, 0 where
/// that is 0.04 h or less. Coordinates of less than 5 values are not rounded: they are those of a plate that stands straight. O(N log N).
[[nodiscard]] double rounding_deviation(const PointSet& set);

/// The same, but 0 where the points are exact, as those of a box with integer coordinates are: where the median residual of the height
/// fields above is less than half of what rounding leaves, in units of the steps, in which voxels of slices that are far apart are cubes.
[[nodiscard]] double rounding_noise(const PointSet& set);

/// The noise where it is largest, if all scatter is noise: of scans that do not fit onto each other, or of noise that differs from place to
/// place, of which estimate_noise() finds the least. From the scatter x h of two thirds of the height fields above (measured within
/// 20 % from 0.1 to 1 h):
///     sigma = h x / sqrt(1 - (x / 0.57)^4).
/// Walls and detail below the spacing lift it: not an estimate, but what to try. 0 for fewer than 192 points, or where planes as above show
/// that there is no noise. Units and cost as above.
[[nodiscard]] double largest_scatter(const PointSet& set);

/// Standard deviation of the points about the facets of a CAD model: what find_likeliest_plane() finds at most of about 500 points. Planes
/// of bends do not count: among the 132 nearest points they have more from w to 2 w away than a quarter of those up to w = 2.5 scatters. A
/// scanner scatters alike everywhere, detail does not, so two adjacent ones of its steps have to hold a third of the points; else 0, and 0
/// for exact points. It sees a scatter too small to blur anything, for which estimate_noise() is 0, and that of walls closer together than
/// the sampling. 0 for fewer than 192 points. About 20 ms.
[[nodiscard]] double facet_scatter(const PointSet& set);

/// Along each axis, the least step between coordinates, not counting those up to 0.001 typical spacings; 0 where it is 0.04 spacings or
/// less, or there are fewer than 5 values. Others need not be multiples of it: those of depths that are rounded as disparities are not.
/// Same units as the points. O(N log N).
[[nodiscard]] Vec3 rounding_steps(const std::vector<Vec3>& points, double spacing);

/// How the number of points grows with the distance from one, as its power: about 2 on a surface, noisy or not, nearly 3 in a volume (2.6
/// to 3 of 800 points and more, of fewer from 2.4: its boundary counts). From the distances r of the neighbours f = min(1024, N / 16) and
/// n = f / 4, rounded down, ln(f / n) / ln(r_f / r_n), the median over about 500 points; 2 for fewer than 192. O(f log N).
[[nodiscard]] double dimension(const PointSet& set);

}  // namespace g3r
