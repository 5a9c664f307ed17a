// Points that lie in lines: scan lines, wires, slices. Along the lines they say more than across.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// The share of points along curves from which a place, or a cloud, is sampled in lines: none of a random sample are, where lines cross
/// few, and of wireframes a quarter and more.
inline constexpr double kInLines = 0.25;

/// Marks (1) the points that lie along a curve with their 8 nearest. `near`: Neighbours::of_all(k) of the points, k >= 9. O(N).
[[nodiscard]] std::vector<std::uint8_t> points_along_curves(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near);

/// Marks (1) the points of which a quarter of the 16 nearest lie along a curve with their 8 nearest; if that are half of all, all are.
/// `near`: Neighbours::of_all(k) of the points, k >= 16. Random samples of surfaces, their creases and rims are not marked. O(N).
[[nodiscard]] std::vector<std::uint8_t> points_in_lines(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near);

/// The spacing up to which surface is held: half of the way to the next line for points_in_lines(), as far as one of the 256 nearest points
/// is on it, and `spacing` elsewhere, and where that is more. O(N log N).
[[nodiscard]] std::vector<double> spacing_across_lines(const std::vector<Vec3>& points, const std::vector<double>& spacing);

}  // namespace g3r::mesh
