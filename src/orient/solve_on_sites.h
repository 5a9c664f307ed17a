// Clouds of lines, solved for on a surface.
#pragma once

#include "base/stages.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

namespace g3r {

/// Where the samples are lines, the points along one are no surface: the problem is solved for, open surfaces apart, on sites as far apart
/// as the lines (place_sites()), which are one. The points of a site share its area vector and have its part, certainty and certificate;
/// those that are sites themselves have its normal, for the others the refinement is evaluated, as wide as the sites of their distance are
/// apart. `problem`: with a line_distance. Throws Cancelled.
[[nodiscard]] Solution solve_on_sites(const Problem& problem, const Options& options, Stages& stages, Stats& stats);

/// Solves a problem, open surfaces apart, on its points, or on sites if all of them are lines. Where some are, both are hypotheses: the one
/// whose normals have the lesser jump_defects() at the sites counts. Lines on closed parts are none. Forgets the lines if the points count.
/// Adds to `stats` like solve_parts(). Throws Cancelled.
[[nodiscard]] Solution solve_with_lines(Problem& problem, const Options& options, Stages& stages, Stats& stats);

}  // namespace g3r
