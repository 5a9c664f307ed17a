#include "orient/coarse_to_fine.h"

#include "orient/polish.h"
#include "orient/refine.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "sum/fast_sum.h"

#include <memory>

namespace g3r {
namespace {

constexpr std::size_t kThinning = 4;  // points per coarse point: twice the spacing
constexpr double kSpacingRatio = 2;
constexpr double kCubeRatio = kSpacingRatio * kSpacingRatio * kSpacingRatio;  // of the weights of the winding number
constexpr std::size_t kFewestCoarsePoints = 10000;                            // a coarser start costs sides on thin parts and saves little
constexpr double kCoarseShare = 0.2;                                          // of the progress bar
constexpr double kDoubtfulShare = 0.04;                                       // share of the points from which more steps are tried
constexpr double kWorse = 1.25;                                               // of that share after them, from which they are undone

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

IterativeResult solve_level(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                            double share, Stages& stages);

// The winding gradient at `points` of the solution on a quarter of them, or nothing when there are too few.
std::vector<Vec3> coarse_gradient(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                                  double share, Stages& stages) {
  if (!starts_coarse(settings, points.size())) return {};
  std::vector<Vec3> some;
  std::vector<std::uint64_t> codes;
  for (std::size_t i = kThinning / 2; i < points.size(); i += kThinning) {
    some.push_back(points[i]);
    codes.push_back(morton[i]);
  }
  const Settings coarse = coarser(settings);
  const std::vector<Vec3> eta = solve_level(some, codes, coarse, kCoarseShare * share, stages).eta;
  const FastSum sum(some, codes, Widths(coarse.refinement_width), coarse.sums, stages.cancel());
  return sum.winding_gradient_at(eta, points, stages.cancel());
}

double unsure_share_of(FastSum& field, const std::vector<Vec3>& eta) {
  const Refinement refined = refine_normals(field, eta);
  return unsure_share(side_confidence(eta, refined.normals, refined.strength, {}));
}

// `share`: of all progress, where this level ends; the coarser ones take kCoarseShare of it.
IterativeResult solve_level(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                            double share, Stages& stages) {
  std::vector<Vec3> start = coarse_gradient(points, morton, settings, share, stages);
  const bool coarsest = start.empty();
  FastSum sum(points, morton, Widths(coarsest ? settings.coarsest_epsilon : settings.epsilon),
              coarsest ? settings.first_sums : settings.sums, stages.cancel());
  if (!coarsest) gradient_to_areas(sum, {settings.spacing * settings.spacing}, start);
  std::unique_ptr<LinearSystem> system;
  if (settings.method == Method::kGreen) {
    system = std::make_unique<GreenSystem>(sum, points, settings.harmonics, settings.constant_weight);
  } else {
    system = std::make_unique<EnergySystem>(sum, settings.damping, settings.winding_weight);
  }
  if (coarsest) {
    return solve_iteratively(*system, settings.schedule, settings.tolerance, {},
                             [&](int step, int steps, double) { stages.progress(share * step / steps); });
  }
  const double tolerance = settings.continued_tolerance;
  IterativeResult result =
      solve_iteratively(*system, settings.continued_schedule, tolerance, std::move(start),
                        [&](int step, int steps, double) { stages.progress(share * (kCoarseShare + (1 - kCoarseShare) * step / steps)); });
  if (result.converged || settings.doubtful_schedule.empty()) return result;
  FastSum field(points, morton, Widths(settings.refinement_width), settings.sums, stages.cancel());
  const double unsure = unsure_share_of(field, result.eta);
  if (unsure < kDoubtfulShare + settings.unsure_of_noise) return result;
  FastSum wider(points, morton, Widths(settings.coarsest_epsilon), settings.first_sums, stages.cancel());
  EnergySystem heavier(wider, settings.damping, settings.doubtful_winding_weight);
  IterativeResult more = solve_iteratively(heavier, settings.doubtful_schedule, settings.doubtful_tolerance, result.eta,
                                           [&](int, int, double) { stages.still_going(); });
  if (settings.unsure_of_noise == 0 && unsure_share_of(field, more.eta) > kWorse * unsure) return result;
  more.kinds.insert(more.kinds.begin(), result.kinds.begin(), result.kinds.end());
  more.residuals.insert(more.residuals.begin(), result.residuals.begin(), result.residuals.end());
  return more;
}
}  // namespace

bool starts_coarse(const Settings& settings, std::size_t points) {
  return settings.coarse_to_fine && points / kThinning >= kFewestCoarsePoints;
}

IterativeResult solve_coarse_to_fine(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                                     Stages& stages) {
  return solve_level(points, morton, settings, 1, stages);
}

}  // namespace g3r
