#include "baselines/baseline.h"

#include "baselines/gauss_system.h"
#include "solve/refine.h"

#include <g3r/error.h>

#include <numbers>

namespace g3r {
namespace {

// The width of PGR and AGR in spacings: with it -grad w of a flat patch is that of the published clamp at 0.75 spacings.
constexpr double kBaselineWidth = 0.4;
// The damping of PGR, alpha - 1: the authors advise 0.05 to 1 from many points to few; this is better than both at 50,000 points.
constexpr double kPgrDamping = 0.2;
// The damping of AGR: the mean AE_p of five models at 5,000 points is 7.98e-2 (with 0.05), 5.10e-2 (0.2), 3.71e-2 (1), 4.41e-2 (5).
constexpr double kAgrDamping = 1;
// PGR and AGR stop at this residual, or after these steps: their damped systems are there before.
constexpr double kTolerance = 1e-3;
constexpr const char* kSchedule = "100 cg";
const std::vector<Vec3> kNoStretch{{1, 1, 1}};
const std::vector<Vec3> kThreeStretches{{3, 1, 1}, {1, 3, 1}, {1, 1, 3}};

void require(bool good, const char* message) {
  if (!good) throw InvalidInput(message);
}

BaselineResult solve_gauss(const CanonicalCloud& cloud, const BaselineSettings& settings, Stages& stages) {
  const bool agr = settings.method == Method::kAgr;
  GaussSystem system(cloud.points(), agr ? kThreeStretches : kNoStretch, settings.epsilon, agr ? kAgrDamping : kPgrDamping, settings.sums,
                     stages.cancel());
  IterativeResult solved = solve_iteratively(system, settings.schedule, settings.tolerance, {},
                                             [&](int step, int steps, double) { stages.progress(static_cast<double>(step) / steps); });
  BaselineResult result;
  result.eta = std::move(solved.eta);
  result.normals = normalised(result.eta);
  result.converged = solved.converged || settings.tolerance == 0;
  for (std::size_t i = 0; i < solved.residuals.size(); ++i) {
    result.iterations.push_back({solved.kinds[i] == StepKind::kSteepestDescent ? "sd" : "cg", solved.residuals[i]});
  }
  return result;
}

}  // namespace

bool is_baseline(Method method) { return method == Method::kWnnc || method == Method::kAgr || method == Method::kPgr; }

BaselineSettings choose_baseline(const Options& options, double given_epsilon, double spacing, const SumPlan& sums) {
  const bool wnnc = options.method == Method::kWnnc;
  require(!wnnc || given_epsilon == 0, "wnnc has wnnc_widths and no epsilon");
  require(!wnnc || (options.schedule.empty() && options.tolerance < 0), "wnnc has 40 iterations and no schedule or tolerance");
  BaselineSettings s;
  s.method = options.method;
  s.sums = sums;
  if (wnnc) {
    s.widths = wnnc_widths(options.wnnc_widths, spacing);
    s.epsilon = s.widths.narrowest;
    return s;
  }
  s.epsilon = given_epsilon > 0 ? given_epsilon : kBaselineWidth * spacing;
  s.schedule = parse_schedule(options.schedule.empty() ? kSchedule : options.schedule);
  s.tolerance = options.tolerance >= 0 ? options.tolerance : kTolerance;
  return s;
}

std::size_t baseline_memory(const BaselineSettings& settings, double spacing, std::size_t points) {
  constexpr std::size_t kPerSum = 1100;  // Bytes of a point in a sum: those of planned_memory() without the neighbours.
  if (settings.method == Method::kAgr) return 2 * kPerSum * points;
  const double reach = settings.widths.widest / spacing;  // 0 for pgr
  return static_cast<std::size_t>(static_cast<double>(points) * 2 * sizeof(std::uint32_t) * std::numbers::pi * reach * reach);
}

BaselineResult solve_baseline(const CanonicalCloud& cloud, const BaselineSettings& settings, Stages& stages) {
  if (settings.method != Method::kWnnc) return solve_gauss(cloud, settings, stages);
  WnncResult solved = solve_wnnc(cloud.points(), settings.widths, settings.sums, stages);
  BaselineResult result{std::move(solved.eta), std::move(solved.normals), std::move(solved.strength), {}, true};
  for (const double residual : solved.residuals) result.iterations.push_back({"wnnc", residual});
  return result;
}

}  // namespace g3r
