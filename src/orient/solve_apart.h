// Open surfaces and the rest of the cloud, each without the other in its equations.
#pragma once

#include "base/stages.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

namespace g3r {

/// Solves a problem on its points (solve()), and its parts apart where some are open: an open surface makes the equations of everything
/// beside it wrong too. So each one whose enclosure is above 2/3, as no bowl up to half a sphere has it, is solved for alone, which may
/// show that it was none, and then everything else without them, unless the others have no part in the equations: the mean size of their
/// winding number at the points is at most 0.02, of 1/2. Without an open surface, or with one that is all there is, and without
/// Step::kApart, this is solve(). What is known to be open (known_open_points()) is not solved for (as_known_open()), and all else without
/// it. Adds to `stats` like solve(); it has converged if all that is not open has. Throws Cancelled.
[[nodiscard]] Solution solve_parts(const Problem& problem, const Options& options, Stages& stages, Stats& stats);

}  // namespace g3r
