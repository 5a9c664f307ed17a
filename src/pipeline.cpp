// The whole program on one page: one line per step (orient_in_arena), in the order of the drawing in docs/design.md.
#include "base/stages.h"
#include "cpu/parallel.h"
#include "field/areas.h"
#include "mesh/findings.h"
#include "orient/apply_hints.h"
#include "orient/attempt.h"
#include "orient/callers_order.h"
#include "orient/describe.h"
#include "orient/hints.h"
#include "orient/noise_choice.h"
#include "orient/noisy_surface.h"
#include "orient/outlier_normals.h"
#include "orient/problem.h"
#include "orient/solution.h"
#include "orient/start.h"
#include "sum/device_scope.h"

#include <g3r/g3r.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace g3r {
namespace {

void replace_areas(const Problem& problem, Stages& stages, Solution& solution) {
  if (!problem.replaces_areas()) return;
  solution.eta = area_vectors(problem.cloud.set, solution.refinement.normals, solution.open_surfaces, stages.cancel());
}

Orientation orient_in_arena(const PointsView& points, Known known, const Options& options, Stages& stages,
                            std::vector<std::uint8_t>* open) {
  Problem prepared = prepare(points, std::move(known), options, stages);
  Attempt best = attempt(std::move(prepared), points, options, stages);
  best = with_best_noise(std::move(best), points, options, stages);
  polish_on_walls(best, options, stages);
  const Problem& problem = best.problem;
  Solution& solution = best.oriented.solution;
  std::vector<float>& confidence = best.oriented.confidence;
  Orientation out;
  out.stats = std::move(best.stats);
  const bool is_whole = problem.known.wanted.empty();  // what surroundings and a part of a cloud look like says nothing of it
  fit_noisy_surface(problem, stages, solution);
  if (is_whole) warn_of_sampling(problem.cloud, solution.refinement.normals, out.stats);  // while neighbours are known
  replace_areas(problem, stages, solution);
  apply_hints(problem, options, solution, confidence, out.stats, stages.cancel());
  if (is_whole) warn_of_volume(problem, out.stats);
  if (is_whole) warn_of_few_points(confidence, out.stats);
  add_outliers(problem, stages, solution, confidence);
  if (open != nullptr) *open = open_in_callers_order(problem.cloud, solution.open_surfaces);
  to_callers_order(problem.cloud, solution, confidence, out);
  stages.finish(out.stats);
  return out;
}

}  // namespace

Orientation orient(const PointsView& points, const Options& options, const Monitor& monitor) {
  return orient_from(points, {}, options, monitor);
}

Orientation orient_from(const PointsView& points, Known known, const Options& options, const Monitor& monitor,
                        std::vector<std::uint8_t>* open) {
  Stages stages(monitor);
  return parallel::with_threads(options.threads, [&] {
    const gpu::Scope device(options.device, points.count);
    stages.time_device([&device] { return device.seconds(); });
    Orientation out = orient_in_arena(points, std::move(known), options, stages, open);
    device.describe(out.stats);
    return out;
  });
}

Stats plan(const PointsView& points, const Options& options) { return plan_of(points, options, {}); }

Stats plan_of(const PointsView& points, const Options& options, const Monitor& monitor) {
  Stages stages(monitor);
  return parallel::with_threads(options.threads, [&] {
    Stats stats;
    const Problem problem = prepare(points, {}, options, stages);
    describe(problem, points, options, stats);
    warn_of_flat(problem.cloud, stats);
    stages.finish(stats);
    return stats;
  });
}

}  // namespace g3r
