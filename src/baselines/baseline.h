// The earlier methods that g3r can run in its own frame, with its own sums, so that one program compares them.
#pragma once

#include "base/stages.h"
#include "baselines/wnnc.h"
#include "cloud/canonical_cloud.h"
#include "solve/iterative_solver.h"
#include "sum/sum_plan.h"

#include <g3r/g3r.h>

#include <vector>

namespace g3r {

[[nodiscard]] bool is_baseline(Method method);

/// What a baseline needs to know, in normalised units.
struct BaselineSettings {
  Method method = Method::kWnnc;
  WnncWidths widths;            ///< wnnc
  double epsilon = 0;           ///< agr, pgr: width of the mollifier; wnnc: the last cut-off width
  std::vector<Steps> schedule;  ///< agr, pgr
  double tolerance = 0;         ///< agr, pgr: stop at this relative residual
  SumPlan sums;
};

/// After choose_settings(), which has refused harmonics and the dense solver. `given_epsilon`: options.epsilon in normalised units, 0 when
/// automatic. Throws InvalidInput for options that wnnc has not: epsilon, schedule and tolerance; and for unknown wnnc_widths.
[[nodiscard]] BaselineSettings choose_baseline(const Options& options, double given_epsilon, double spacing, const SumPlan& sums);

/// Memory beyond that of a single sum, in bytes: near pairs (wnnc), two more sums (agr).
[[nodiscard]] std::size_t baseline_memory(const BaselineSettings& settings, double spacing, std::size_t points);

struct BaselineResult {
  std::vector<Vec3> eta;
  std::vector<Vec3> normals;
  std::vector<double> strength;  ///< |grad w| where the method computes it (wnnc), else empty
  std::vector<Iteration> iterations;
  bool converged = false;  ///< wnnc: always, it has no stopping rule
};

/// Throws Cancelled.
[[nodiscard]] BaselineResult solve_baseline(const CanonicalCloud& cloud, const BaselineSettings& settings, Stages& stages);

}  // namespace g3r
