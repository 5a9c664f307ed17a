// How the heights of points over a smooth surface are distributed: about one wall, or about two.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Second moment, kurtosis and correlation of the residuals r = M z of heights z over the cubic height field fitted to them, M the
/// projection off its 10 columns. Normal noise of any size leaves r in a uniform direction of n - 10 dimensions, so that
///     excess = (sum r^4 (n - 10) (n - 8) / ((sum r^2)^2 sum M_ii^2) - 3) sum M_ii^2 / sum M_ii^4
/// has the mean 0 for any n, whatever sum r^2 is (Basu, "On statistics independent of a complete sufficient statistic", Sankhya 1955). The
/// last factor makes up for the fit, which takes a part of every height: of other noise r_i has about M_ii^4 times its fourth cumulant.
/// Points on two walls, s the noise and 2 a their distance, have about -2 (a^2 / (a^2 + s^2))^2: -2 without noise, -0.5 where the walls are
/// 2 s apart. Noise that differs from point to point has more than 0. Rounding to steps q has the fourth cumulant -sum n_a^4 q_a^4 / 120, n
/// the direction of the heights, which is taken off.
///     correlation = (sum r_k r_j + s^2 (1 - M)_kj) / sum r^2,   j the point next to k across the normal, s^2 = sum r^2 / (n - 10)
/// has the mean 0 where each point has its own noise or takes its wall by chance, and is the share of sum r^2 that is shape where the field
/// leaves some: neighbours have the same. (Moran, "Notes on continuous stochastic phenomena", Biometrika 1950.)
struct HeightMoments {
  double mean_square = 0;  ///< of the residuals, corrected for the 10 numbers; square of the points' unit
  double excess = 0;       ///< of the kurtosis over that of normal noise
  double correlation = 0;  ///< of points next to each other
};

/// `index`: `count` > 10 points; `normal`: unit vector that heights are along; `h` > 0: length unit of the fit; `steps`: to which each
/// coordinate is rounded, 0 where it is not. Zeros where the points do not determine a cubic, as on a line, or lie on it. O(count^2).
[[nodiscard]] HeightMoments height_moments(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count,
                                           const Vec3& normal, double h, const Vec3& steps = {0, 0, 0});

/// The mean of many, and how far chance carries it.
struct MeanExcess {
  double mean = 0;
  double error = 0;        ///< standard error
  double correlation = 0;  ///< mean of HeightMoments::correlation

  /// The least excess that shape would have by itself: a share c of the squares that takes two values has -2 c^2.
  [[nodiscard]] double of_shape() const;
  /// Whether what looks like one wall may be two that noise hides: the mean is below -2/9, that of walls kWider standard deviations apart,
  /// and more so than shape explains, such as steps of a terrace. What else has light tails looks like two walls: two scans of one surface
  /// that do not fit onto each other, noise that is evenly distributed.
  [[nodiscard]] bool may_be_two_walls() const;
  /// Whether it is, but for one case in a hundred: the mean is 2.5 standard errors below what shape explains too.
  [[nodiscard]] bool is_two_walls() const;
};

/// Of the places whose mean square is at most the median. Under normal noise the excess does not depend on the mean square, so that the
/// choice does not change its mean. `places`: their moments; zeros of fewer than kFewestSites; `disjoint` > 0: as many of their
/// neighbourhoods the points fill, if they share none: no more of them are independent. O(places).
[[nodiscard]] MeanExcess mean_excess(const std::vector<HeightMoments>& places, double disjoint);

}  // namespace g3r
