// Kernels where points are clearly closer together than is typical.
#pragma once

#include "sum/direct_sum.h"

#include <vector>

namespace g3r {

/// What the width of a kernel is taken times where the points are `relative` times as far apart as is typical: that where they are clearly
/// closer (kClearlyLess), else 1. One as wide as elsewhere would reach over detail that they show, as vertices of simplified meshes do, and
/// take time with the square of how many they are; even samples have no such places, and in kernels that followed them everywhere a field
/// is less even.
[[nodiscard]] double narrowing(double relative);

/// Kernels of this width, taken times narrowing(). `spacing`: of every point.
[[nodiscard]] Widths narrowed(double width, const std::vector<double>& spacing, double typical);

}  // namespace g3r
