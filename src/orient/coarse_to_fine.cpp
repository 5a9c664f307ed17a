#include "orient/coarse_to_fine.h"

#include "orient/confidence.h"
#include "orient/open_surfaces.h"
#include "orient/polish.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace g3r {
namespace {

constexpr double kSpacingRatio = 2;
constexpr double kCubeRatio = kSpacingRatio * kSpacingRatio * kSpacingRatio;  // of the weights of the winding number
constexpr double kCoarseShare = 0.2;                                          // of the progress bar
constexpr double kDoubtfulShare = 0.04;                                       // share of the points from which more steps are tried
constexpr double kWorse = 1.25;                                               // of that share after them, from which they are undone
// Points whose field tells open surfaces from closed ones: fewer would lose small parts, more take longer and say the same.
constexpr std::size_t kOpenPoints = 10000;

Settings coarser(Settings settings) {
  settings.spacing *= kSpacingRatio;
  settings.epsilon *= kSpacingRatio;
  settings.coarsest_epsilon *= kSpacingRatio;
  settings.refinement_width *= kSpacingRatio;
  settings.winding_weight *= kCubeRatio;
  settings.doubtful_winding_weight *= kCubeRatio;
  settings.damping /= kSpacingRatio;
  settings.tolerance = settings.start_tolerance;
  settings.first_sums = settings.sums;
  return settings;
}

template <class T>
std::vector<T> every(std::size_t step, const std::vector<T>& values) {
  std::vector<T> some;
  for (std::size_t i = step / 2; i < values.size(); i += step) some.push_back(values[i]);
  return some;
}

// A solution and the sum, of width settings.refinement_width, that evaluates its field.
struct Level {
  IterativeResult result;
  std::unique_ptr<FastSum> field;
};

Level solve_level(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings, double share,
                  Stages& stages, const std::vector<Vec3>& start);

// The winding gradient at `points` of the solution on a quarter of them.
std::vector<Vec3> coarse_gradient(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                                  double share, Stages& stages) {
  const Level coarse = solve_level(every(kThinning, points), every(kThinning, morton), coarser(settings), kCoarseShare * share, stages, {});
  return coarse.field->winding_gradient_at(coarse.result.eta, points, stages.cancel());
}

double unsure_share_of(const std::vector<Vec3>& eta, const Refinement& refined) {
  return unsure_share(side_confidence(eta, refined.normals, refined.strength, {}));
}

// Whether most of the points lie on surfaces without an inside, by the field of some of them.
bool is_mostly_open(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                    const std::vector<Vec3>& normals, const Stages& stages) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / kOpenPoints);
  const PointSet set(every(step, points), every(step, morton));
  std::vector<Vec3> sides = every(step, normals);
  const OpenSurfaces sheets = find_open_surfaces(set, settings.noise, settings.sums, sides, stages.cancel());
  const auto closed = std::count(sheets.part.begin(), sheets.part.end(), OpenSurfaces::kNone);
  return !sheets.part.empty() && 2 * static_cast<std::size_t>(closed) < set.size();
}

std::unique_ptr<LinearSystem> system_of(FastSum& sum, const std::vector<Vec3>& points, const Settings& settings) {
  if (settings.method == Method::kGreen) {
    return std::make_unique<GreenSystem>(sum, points, settings.harmonics, settings.constant_weight);
  }
  return std::make_unique<EnergySystem>(sum, settings.damping, settings.winding_weight);
}

// From eta = 0.
IterativeResult solve_from_zero(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                                double share, Stages& stages) {
  FastSum sum(points, morton, Widths(settings.coarsest_epsilon), settings.first_sums, stages.cancel());
  return solve_iteratively(*system_of(sum, points, settings), settings.schedule, settings.tolerance, {},
                           [&](int step, int steps, double) { stages.progress(share * step / steps); });
}

// From a winding gradient at the points.
IterativeResult solve_on(FastSum& field, const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton,
                         const Settings& settings, double share, Stages& stages, std::vector<Vec3> start) {
  FastSum sum = settings.epsilon <= settings.refinement_width
                    ? FastSum(field, Widths(settings.epsilon))
                    : FastSum(points, morton, Widths(settings.epsilon), settings.sums, stages.cancel());
  gradient_to_areas(sum, {settings.spacing * settings.spacing}, start);
  return solve_iteratively(
      *system_of(sum, points, settings), settings.continued_schedule, settings.continued_tolerance, std::move(start),
      [&](int step, int steps, double) { stages.progress(share * (kCoarseShare + (1 - kCoarseShare) * step / steps)); });
}

// More steps where the sides of many points are unsure, but for surfaces of which the equations are not true.
void settle_doubtful(FastSum& field, const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                     Stages& stages, IterativeResult& result) {
  const Refinement refined = refine_normals(field, result.eta);
  const double unsure = unsure_share_of(result.eta, refined);
  if (unsure < kDoubtfulShare + settings.unsure_of_noise) return;
  if (is_mostly_open(points, morton, settings, refined.normals, stages)) return;
  FastSum wider(points, morton, Widths(settings.coarsest_epsilon), settings.first_sums, stages.cancel());
  EnergySystem heavier(wider, settings.damping, settings.doubtful_winding_weight);
  IterativeResult more = solve_iteratively(heavier, settings.doubtful_schedule, settings.doubtful_tolerance, result.eta,
                                           [&](int, int, double) { stages.still_going(); });
  if (settings.unsure_of_noise == 0 && unsure_share_of(more.eta, refine_normals(field, more.eta)) > kWorse * unsure) return;
  more.kinds.insert(more.kinds.begin(), result.kinds.begin(), result.kinds.end());
  more.residuals.insert(more.residuals.begin(), result.residuals.begin(), result.residuals.end());
  result = std::move(more);
}

// `share`: of all progress, where this level ends; the coarser ones take kCoarseShare of it. `start`: a winding gradient, empty for that of
// the coarser ones.
Level solve_level(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings, double share,
                  Stages& stages, const std::vector<Vec3>& start) {
  Level level;
  const auto make_field = [&] {
    level.field = std::make_unique<FastSum>(points, morton, Widths(settings.refinement_width), settings.sums, stages.cancel());
  };
  if (!starts_coarse(settings, points.size())) {
    level.result = solve_from_zero(points, morton, settings, share, stages);
    if (settings.refinement_width > 0) make_field();
    return level;
  }
  make_field();
  level.result = solve_on(*level.field, points, morton, settings, share, stages,
                          start.empty() ? coarse_gradient(points, morton, settings, share, stages) : start);
  if (!level.result.converged && !settings.doubtful_schedule.empty()) {
    settle_doubtful(*level.field, points, morton, settings, stages, level.result);
  }
  return level;
}

}  // namespace

Solved solve_coarse_to_fine(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                            Stages& stages, const std::vector<Vec3>& start) {
  Level level = solve_level(points, morton, settings, 1, stages, start);
  stages.begin("refine");
  if (settings.refinement_width == 0) return {std::move(level.result), {}};
  Refinement refinement = refine_normals(*level.field, level.result.eta);
  return {std::move(level.result), std::move(refinement)};
}

}  // namespace g3r
