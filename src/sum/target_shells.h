// Targets outside the cube of the sources: everything is shrunk by a power of two until they are in it, one sum for every shell that has
// some. Internal to src/sum.
#pragma once

#include <g3r/points.h>

#include <array>
#include <cstdint>
#include <vector>

namespace g3r::target_shells {

/// Shells with a sum of their own: shell s holds the targets in 2^s times the cube and in no smaller one. The grid has no more levels.
inline constexpr int kShells = 21;
/// Of targets that are farther, or no number.
inline constexpr int kNoShell = kShells;

/// The targets of every shell, and at last those that have none: outside the cube where nothing may shrink (`shrinks` false), or where a
/// shell's kernels, of `width` in the cube, would be too narrow for floats.
[[nodiscard]] std::array<std::vector<std::uint32_t>, kShells + 1> members(const std::vector<Vec3>& targets, double width, bool shrinks);

/// The points with all lengths times `factor`.
[[nodiscard]] std::vector<Vec3> scaled(std::vector<Vec3> points, double factor);

/// Puts the targets of `index`, shrunk by `factor`, into canonical order.
void sort_canonically(const std::vector<Vec3>& targets, double factor, std::vector<std::uint32_t>& index);

}  // namespace g3r::target_shells
