// Morton codes of points, and the order that all steps see the points in.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace g3r {

/// Bits of an axis in a Morton code: 3 x 21 = 63 of 64 bits.
inline constexpr int kGridBits = std::numeric_limits<std::uint64_t>::digits / 3;

/// The lowest 21 bits, each moved to three times its place: one axis of a Morton code.
[[nodiscard]] std::uint64_t spread_bits(std::uint64_t v);

/// Morton code of a point of [-1, 1]^3 on a grid of 2^21 cells per axis: bits x2 y2 z2 x1 y1 z1 x0 y0 z0, x highest. Coordinates outside
/// are clamped.
[[nodiscard]] std::uint64_t morton_code(const Vec3& unit);
/// The codes of N points. O(N).
[[nodiscard]] std::vector<std::uint64_t> morton_codes(const std::vector<Vec3>& unit_points);

/// Indices that sort N points of [-1, 1]^3 by their codes, those of one cell by their coordinates, and equal ones by their index: a
/// permutation of the points permutes the indices, and the sorted points stay the same. O(N), and n log n for n points of one cell.
[[nodiscard]] std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& unit_points);

}  // namespace g3r
