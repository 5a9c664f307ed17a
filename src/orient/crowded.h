// Points so dense that a kernel of the typical width would hold thousands of them.
#pragma once

#include "sum/direct_sum.h"

#include <vector>

namespace g3r {

/// Times that points are closer together than is typical, from which kernels follow their spacing. One as wide as elsewhere reaches 1.6
/// typical spacings and would hold 2000 of them: it shows nothing of a surface that all of these are of, and takes time with their square.
inline constexpr double kCrowded = 16;

/// What the width of a kernel is taken times where the points are `relative` times as far apart as is typical: that where they crowd, else
/// 1.
[[nodiscard]] double narrowing(double relative);

/// Kernels of this width, taken times narrowing(). `spacing`: of every point.
[[nodiscard]] Widths narrowed(double width, const std::vector<double>& spacing, double typical);

}  // namespace g3r
