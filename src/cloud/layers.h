// Points around several sheets of surface, one above the other: how far from their own sheet they are.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Standard deviation of points about parallel sheets. The heights over a plane are taken for draws from a mixture of C Gaussians,
///     z ~ q(u, v) + sum_c share_c N(offset_c, sigma^2),     q a quadratic without constant,
/// fitted by expectation and maximisation (Dempster, Laird, Rubin 1977) for C = 1, 2, 3; the C with the smallest Bayesian information
/// criterion (Schwarz 1978) counts. So two sides of a wall 3 sigma thick are two sheets, where the spread about one is 1.8 sigma.
/// `index`: `count` > 40 points around `centre`, nearest first; those less than 0.6 of the last one's distance away from the axis through
/// `centre` along `normal` take part. Same unit as the points; 0 where fewer than 20 do. O(count).
[[nodiscard]] double layered_deviation(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre,
                                       const Vec3& normal);

/// Two parallel sheets through a few points.
struct TwoSheets {
  double deviation = 0;  ///< of the points from their own sheet, corrected for the 7 numbers
  double gap = 0;        ///< between the sheets; 0: there are not two
};

/// Heights over the plane with this normal, z = q(u, v) + one of two offsets, q a quadratic without constant: least squares, and every
/// point to the nearer offset, in turn (Lloyd, "Least squares quantization in PCM", IEEE Transactions on Information Theory 1982), from the
/// points above and below the middle of one sheet. Noise about one sheet leaves a deviation of 0.3 gaps, of 0.15 in one of fifty cases,
/// walls next to nothing. 8 <= `count` <= 32 points. Same unit as the points. O(count).
[[nodiscard]] TwoSheets fit_two_sheets(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal);

/// How much likelier two parallel sheets nearer than 2 spacings make such points than one sheet, ln per point: n points on two sheets, each
/// with a label that costs ln 2, have the log likelihood -n ln s2 - n ln 2, on one -n ln s1, with s the standard deviation from the fit, of
/// which less than 0.01 spacings is as good as none. O(count).
[[nodiscard]] double two_sheets_gain(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal,
                                     double spacing);

}  // namespace g3r
