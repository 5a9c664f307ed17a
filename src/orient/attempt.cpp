#include "orient/attempt.h"

#include "orient/describe.h"
#include "orient/memory_plan.h"
#include "orient/noisy_surface.h"
#include "orient/open_to_views.h"
#include "orient/site_parts.h"
#include "orient/solution.h"
#include "orient/solve_on_sites.h"

#include <utility>
#include <vector>

namespace g3r {
namespace {

Solution solve_problem(Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (is_seen_in_noise(problem)) return solve_by_sight(problem, stages, stats);
  Solution solution = solve_with_lines(problem, options, stages, stats);
  if (const Views& views = problem.cloud.set.views(); views.known()) {
    open_to_views(views, problem.cloud.points(), solution);
  }
  return solution;
}

// Gives up the memory of what the confidence has of a solution.
void release(const Problem& problem, Solution& solution) {
  std::vector<double>().swap(solution.refinement.strength);
  if (problem.replaces_areas()) std::vector<Vec3>().swap(solution.eta);
}

}  // namespace

Attempt attempt(Problem problem, const PointsView& points, const Options& options, Stages& stages) {
  Attempt out{std::move(problem), {}, {}, {}};
  describe(out.problem, points, options, out.solved);
  require_memory(out.solved.planned_memory_bytes, options.max_memory, false);
  const PointSet& set = out.problem.cloud.set;
  static_cast<void>(set.smoothed_spacing());  // what solve and areas need of the neighbours,
  static_cast<void>(set.spacing());           // and what the certificate does
  make_room_for_sums(set);
  Solution solution = solve_problem(out.problem, options, stages, out.solved);
  out.stats = out.solved;
  out.oriented = assess(out.problem, std::move(solution), out.stats);
  if (!is_projected(out.problem)) release(out.problem, out.oriented.solution);
  return out;
}

void polish_on_walls(Attempt& taken, const Options& options, Stages& stages) {
  if (polish_projected(taken.problem, options, stages, taken.oriented.solution)) {
    taken.stats = taken.solved;
    taken.oriented = assess(taken.problem, std::move(taken.oriented.solution), taken.stats);
  }
  release(taken.problem, taken.oriented.solution);
}

}  // namespace g3r
