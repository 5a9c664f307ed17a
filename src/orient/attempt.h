// One try at a problem: it is described, solved and assessed.
#pragma once

#include "base/stages.h"
#include "orient/assess.h"
#include "orient/problem.h"

#include <g3r/g3r.h>

namespace g3r {

/// A problem, its solution, and the statistics of both.
struct Attempt {
  Problem problem;
  Oriented oriented;
  Stats solved;  ///< before the sides were assessed
  Stats stats;
};

/// Describes the problem (describe()), solves it, open surfaces apart from the rest, and assesses the solution (assess()). What sensors
/// have seen from known places faces them: open_to_views(), or solve_by_sight() without any equations. `points`: those that the problem is
/// made of. Gives up the memory of what is not needed any more, unless polish_on_walls() needs it. Throws what require_memory() throws,
/// before anything is solved, and Cancelled.
[[nodiscard]] Attempt attempt(Problem problem, const PointsView& points, const Options& options, Stages& stages);

/// For the attempt that is taken in the end: moves noisy points onto their walls and polishes them there, if that is for this problem
/// (polish_projected()), and assesses the sides anew. Then gives up the memory of what only the assessment needs, which are the strengths,
/// and the area vectors where Problem::replaces_areas().
void polish_on_walls(Attempt& taken, const Options& options, Stages& stages);

}  // namespace g3r
