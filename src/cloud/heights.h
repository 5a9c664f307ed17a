// How the heights of points over a smooth surface are distributed: about one wall, or about two.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Second moment and kurtosis of the residuals r = M z of heights z over the cubic height field fitted to them, M the projection off its
/// 10 columns. Normal noise of any size leaves r in a uniform direction of n - 10 dimensions, so that
///     excess = (sum r^4 (n - 10) (n - 8) / ((sum r^2)^2 sum M_ii^2) - 3) sum M_ii^2 / sum M_ii^4
/// has the mean 0 for any n, whatever sum r^2 is (Basu, "On statistics independent of a complete sufficient statistic", Sankhya 1955). The
/// last factor makes up for the fit, which takes a part of every height: of other noise r_i has about M_ii^4 times its fourth cumulant.
/// Points on two walls, s the noise and 2 a their distance, have about -2 (a^2 / (a^2 + s^2))^2: -2 without noise, -0.5 where the walls are
/// 2 s apart. Noise that differs from point to point has more than 0.
struct HeightMoments {
  double mean_square = 0;  ///< of the residuals, corrected for the 10 numbers; square of the points' unit
  double excess = 0;       ///< of the kurtosis over that of normal noise
};

/// `index`: `count` > 10 points; `normal`: unit vector that heights are along; `h` > 0: length unit of the fit. Zeros where the points do
/// not determine a cubic, as on a line, or lie on it. O(count).
[[nodiscard]] HeightMoments height_moments(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count,
                                           const Vec3& normal, double h);

}  // namespace g3r
