// Clouds of lines, solved for on a surface.
#pragma once

#include "base/stages.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

namespace g3r {

/// Where the samples are lines, the points along one are no surface: the problem is solved for, open surfaces apart, on sites as far apart
/// as the lines (place_sites()), which are one. The points of a site share its area vector and have its part, certainty and certificate;
/// the refinement is evaluated at every point. `problem`: of a line_distance above 0. Throws Cancelled.
[[nodiscard]] Solution solve_on_sites(const Problem& problem, const Options& options, Stages& stages, Stats& stats);

}  // namespace g3r
