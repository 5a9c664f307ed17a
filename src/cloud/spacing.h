// Local and typical spacing of a point set.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Of the unit frame, whose box has side 2 / 1.1. A surface sampled so finely has 1e12 points; the sums take 1 / width to the fifth power,
/// which leaves the range of float not far below.
inline constexpr double kLeastSpacing = 1e-6;

/// Nearest others that say how far apart points are: enough to average out random sampling, few enough to stay local.
inline constexpr std::size_t kClosest = 8;

/// Length of the lists of near points: a point itself and its 16 nearest, twice as many as one spacing takes, to average spacings.
inline constexpr std::size_t kSpacingNeighbours = 2 * kClosest + 1;

/// h_i = d_k sqrt(pi / k), d_k the distance of point i to its k-th neighbour, k = 8: the square root of the area per point of a surface
/// sample (docs/math.md, "Spacing"). Two points and more, in the unit frame; fewer than 9: k = N - 1. N values, none below kLeastSpacing.
/// O(N log N).
[[nodiscard]] std::vector<double> local_spacing(const std::vector<Vec3>& points);
/// The same from Neighbours::of_all(k) of these points, k >= 9.
[[nodiscard]] std::vector<double> local_spacing(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near);

/// Local spacings averaged (geometric mean) over each point's 16 nearest, itself included: they follow the density, not the scatter of
/// the sample. `near`: Neighbours::of_all(k), k >= 16. O(N).
[[nodiscard]] std::vector<double> smoothed_spacing(const std::vector<double>& local, const std::vector<std::uint32_t>& near);

/// Local spacings divided by `relative_spacing`, how many times as far apart each point is because the cloud has been thinned there; as
/// they are if that is empty. O(N).
[[nodiscard]] std::vector<double> spacing_before_thinning(std::vector<double> local, const std::vector<double>& relative_spacing);

/// The typical spacing: the median of the local ones, which a few far points cannot move.
[[nodiscard]] double typical_spacing(std::vector<double> local);

}  // namespace g3r
