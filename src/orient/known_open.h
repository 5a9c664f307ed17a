// Open surfaces where it is known which points lie on them, and their sides.
#pragma once

#include "orient/problem.h"
#include "orient/solution.h"

#include <cstdint>
#include <vector>

namespace g3r {

/// The points that Known::open marks, ascending: none where they are fewer than a surface needs, all where the others are. O(N).
[[nodiscard]] std::vector<std::uint32_t> known_open_points(const Problem& problem);

/// The solution of a problem all of whose points are known to be open: one surface whose sides, those of Known::gradient
/// (sides_as_known()), agree and are a choice. Directions and areas are those of find_open_surfaces() and solve(), without any equations.
/// Throws Cancelled. O(N log N).
[[nodiscard]] Solution as_known_open(const Problem& problem, Stages& stages);

}  // namespace g3r
