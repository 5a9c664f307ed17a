#include "solution.h"

#include "baselines/baseline.h"
#include "cloud/clusters.h"
#include "cloud/neighbours.h"
#include "cloud/spacing.h"
#include "orient/coarse_to_fine.h"
#include "orient/creases.h"
#include "orient/facets.h"
#include "orient/jets.h"
#include "orient/noisy_jets.h"
#include "orient/planes.h"
#include "orient/polish.h"
#include "solve/dense_solver.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "solve/iterative_solver.h"
#include "sum/fast_sum.h"

#include <map>
#include <utility>

namespace g3r {
namespace {

constexpr std::size_t kFewestApart = 100;  // points that are solved for again without the open sheets of their cloud
constexpr double kAtOdds = 1e-3;           // share of the points against most of their facet, from which facets are solved for
constexpr int kFacetRounds = 3;            // points on no facet come right after those on one, and facets grow
constexpr double kSameSide = 0.5;          // cosine between the normals of a point and of its cluster on an open sheet

void record(const Settings& s, const IterativeResult& result, Stats& stats) {
  stats.converged = result.converged || s.tolerance == 0 || (!result.residuals.empty() && result.residuals.back() <= s.accepted_residual);
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    stats.iterations.push_back({result.kinds[i] == StepKind::kSteepestDescent ? "sd" : "cg", result.residuals[i]});
  }
}

Solution solve_by_baseline(const Problem& problem, Stages& stages, Stats& stats) {
  stages.begin("solve");
  BaselineResult result = solve_baseline(problem.cloud, *problem.baseline, stages);
  stats.converged = result.converged;
  stats.iterations = std::move(result.iterations);
  return {std::move(result.eta), {std::move(result.normals), std::move(result.strength)}, {}};
}

// Area vectors, and their refinement unless its width is 0.
Solution solve_equations(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const std::vector<Vec3>& points = problem.cloud.points;
  stages.begin("solve");
  if (!s.dense) {
    Solved solved = solve_coarse_to_fine(points, problem.cloud.morton, s, stages);
    record(s, solved.result, stats);
    return {std::move(solved.result.eta), std::move(solved.refinement), {}};
  }
  const HarmonicValues u = weighted_harmonics(s.harmonics, points, s.constant_weight);
  DenseResult dense = solve_dense(points, s.epsilon, u, options.condition_number, stages.cancel());
  stats.converged = true;
  stats.condition_number = dense.condition_number;
  Solution solution;
  solution.eta = std::move(dense.eta);
  stages.begin("refine");
  if (s.refinement_width == 0) return solution;
  FastSum sum(points, problem.cloud.morton, Widths(s.refinement_width), s.sums, stages.cancel());
  solution.refinement = refine_normals(sum, solution.eta);
  return solution;
}

// Points on open sheets get area vectors along the normals found for them.
void set_sheet_areas(const OpenSheets& sheets, const std::vector<double>& spacing, const std::vector<Vec3>& normals,
                     std::vector<Vec3>& eta) {
  for (std::size_t i = 0; i < sheets.sheet.size(); ++i) {
    if (sheets.sheet[i] == OpenSheets::kNone) continue;
    for (std::size_t a = 0; a < 3; ++a) eta[i][a] = spacing[i] * spacing[i] * normals[i][a];
  }
}

// Where the points of a cloud's facets disagree about their sides, every facet gets one, and the other points their normals from the field
// of what the facets have become. `fit` proves normals; `proven`: those it has.
template <typename Fit>
void agree_on_facets(const Problem& problem, const std::vector<std::uint8_t>& proven, const Fit& fit, std::vector<Vec3>& eta,
                     std::vector<Vec3>& normals, Stages& stages) {
  const std::vector<Vec3>& points = problem.cloud.points;
  const Settings& s = problem.settings;
  for (int round = 0; round < kFacetRounds; ++round) {
    const Facets facets = find_facets(points, problem.near, problem.local_spacing, proven, normals);
    if (share_at_odds(facets, normals) < kAtOdds) return;
    choose_facet_sides(points, problem.cloud.morton, s, problem.local_spacing, facets, eta, normals, stages);
    FastSum sum(points, problem.cloud.morton, local_widths(s.polish_width, s, problem.local_spacing), s.sums, stages.cancel());
    const Refinement refined = refine_normals(sum, eta);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (facets.of[i] == Facets::kNone) normals[i] = refined.normals[i];
    }
    fit();
  }
}

// The normals of a clean cloud, where its points prove what the surface is.
void fit_surface(const Problem& problem, std::vector<Vec3>& eta, std::vector<Vec3>& normals, Stages& stages) {
  const std::vector<Vec3>& points = problem.cloud.points;
  const std::vector<double>& spacing = problem.local_spacing;
  const Neighbours neighbours(points);
  std::vector<std::uint8_t> proven;
  const auto fit = [&] {
    proven = fit_jets(points, problem.near, spacing, normals);
    fit_planes(points, neighbours, spacing, proven, normals);
  };
  fit();
  if (sharpen_creases(points, problem.near, spacing, normals)) fit();
  agree_on_facets(problem, proven, fit, eta, normals, stages);
}

Solution solve_on_points(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const std::vector<Vec3>& points = problem.cloud.points;
  Solution solution = solve_equations(problem, options, stages, stats);
  if (s.refinement_width == 0) solution.refinement.normals = normalised(solution.eta);
  if (s.polish_steps == 0) return solution;
  Polished polished = polish(points, problem.cloud.morton, s, problem.local_spacing, {}, solution.refinement, stages);
  std::vector<Vec3>& normals = polished.refinement.normals;
  OpenSheets sheets;
  if (problem.local_spacing.empty()) {  // noisy
    const Neighbours neighbours(points);
    const NoisyCloud noisy{points, neighbours, s.noise, problem.spacing};
    sheets = find_open_sheets(points, {}, &noisy, normals);
    if (!sheets.sheet.empty()) set_sheet_areas(sheets, local_spacing(points), normals, polished.eta);
  } else {
    sheets = find_open_sheets(points, problem.near, nullptr, normals);
    set_sheet_areas(sheets, problem.local_spacing, normals, polished.eta);
    fit_surface(problem, polished.eta, normals, stages);
  }
  return {std::move(polished.eta), std::move(polished.refinement), std::move(sheets)};
}

// From clusters to their points, whose normals face the side of the cluster's.
void spread_sheets(const OpenSheets& sheets, const Clusters& clusters, const std::vector<Vec3>& cluster_normals, Solution& solution) {
  if (sheets.sheet.empty()) return;
  for (std::size_t i = 0; i < solution.eta.size(); ++i) {
    const std::uint32_t c = clusters.cluster_of[i];
    solution.sheets.sheet.push_back(sheets.sheet[c]);
    solution.sheets.certainty.push_back(sheets.certainty[c]);
    if (sheets.sheet[c] == OpenSheets::kNone) continue;
    Vec3& n = solution.refinement.normals[i];
    const Vec3& side = cluster_normals[c];
    if (n[0] * side[0] + n[1] * side[1] + n[2] * side[2] < kSameSide) n = side;
  }
}

Refinement solve_clusters(const Clusters& clusters, const Settings& s, Stages& stages, Stats& stats) {
  stages.begin("solve");
  FastSum sum(clusters.points, clusters.morton, Widths(s.epsilon), s.first_sums, stages.cancel());
  EnergySystem system(sum, s.damping, s.winding_weight, clusters.multiplicity);
  IterativeResult result = solve_iteratively(system, s.schedule, s.tolerance, {},
                                             [&](int step, int steps, double) { stages.progress(static_cast<double>(step) / steps); });
  record(s, result, stats);
  stages.begin("refine");
  FastSum wide(clusters.points, clusters.morton, Widths(s.refinement_width), s.sums, stages.cancel());
  return refine_normals(wide, system.to_areas(std::move(result.eta)));
}

// Where the kernels are so wide that they see groups of points: the same equations on one point per group, all of whose area vectors are
// equal. The refinement is evaluated at every point.
Solution solve_on_clusters(const Problem& problem, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const Clusters clusters = cluster_points(problem.cloud.points, problem.cloud.morton, s.cluster_side);
  const Refinement first = solve_clusters(clusters, s, stages, stats);
  Polished polished = polish(clusters.points, clusters.morton, s, {}, clusters.multiplicity, first, stages);
  std::vector<Vec3>& eta = polished.eta;
  const Neighbours neighbours(problem.cloud.points);
  const NoisyCloud noisy{problem.cloud.points, neighbours, s.noise, problem.spacing};
  OpenSheets sheets;
  if (problem.noise > 0) sheets = find_open_sheets(clusters.points, {}, &noisy, polished.refinement.normals);
  if (!sheets.sheet.empty()) set_sheet_areas(sheets, local_spacing(clusters.points), polished.refinement.normals, eta);
  const FastSum field(clusters.points, clusters.morton, Widths(s.polish_width), s.sums, stages.cancel());
  Solution solution;
  solution.eta.resize(problem.cloud.size());
  for (std::size_t i = 0; i < solution.eta.size(); ++i) {
    const std::uint32_t c = clusters.cluster_of[i];
    for (std::size_t a = 0; a < 3; ++a) solution.eta[i][a] = eta[c][a] / clusters.multiplicity[c];
  }
  solution.refinement = unit_normals(field.winding_gradient_at(eta, problem.cloud.points, stages.cancel()), solution.eta);
  spread_sheets(sheets, clusters, polished.refinement.normals, solution);
  return solution;
}

// Solves for some points (ascending) without the others.
void solve_apart(const Problem& problem, const std::vector<std::uint32_t>& some, const Options& options, Stages& stages, Stats& stats,
                 Solution& solution) {
  if (some.size() < kFewestApart) return;
  const Solution apart = solve(part_of(problem, some, options), options, stages, stats);
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    solution.eta[i] = apart.eta[k];
    solution.refinement.normals[i] = apart.refinement.normals[k];
    solution.refinement.strength[i] = apart.refinement.strength[k];
    const bool open = !apart.sheets.sheet.empty() && apart.sheets.sheet[k] != OpenSheets::kNone;
    solution.sheets.sheet[i] = open ? some[apart.sheets.sheet[k]] : OpenSheets::kNone;
    solution.sheets.certainty[i] = open ? apart.sheets.certainty[k] : 1;
  }
}

}  // namespace

Solution solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (problem.baseline) return solve_by_baseline(problem, stages, stats);
  if (problem.settings.cluster_side > 0) return solve_on_clusters(problem, stages, stats);
  return solve_on_points(problem, options, stages, stats);
}

void solve_sheets_apart(const Problem& problem, const Options& options, Stages& stages, Stats& stats, Solution& solution) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> parts;
  const auto collect = [&] {
    parts.clear();
    for (std::uint32_t i = 0; i < solution.sheets.sheet.size(); ++i) parts[solution.sheets.sheet[i]].push_back(i);
  };
  collect();
  if (parts.size() < 2) return;  // no sheet, or one that is all there is
  for (const auto& [sheet, points] : parts) {
    if (sheet != OpenSheets::kNone) solve_apart(problem, points, options, stages, stats, solution);
  }
  collect();
  if (parts.size() > 1 && parts.count(OpenSheets::kNone) > 0) {
    solve_apart(problem, parts[OpenSheets::kNone], options, stages, stats, solution);
  }
}

void fit_noisy_surface(const Problem& problem, Stages& stages, Solution& solution) {
  if (problem.baseline || problem.noise == 0 || problem.settings.polish_steps == 0) return;
  const std::vector<Vec3>& points = problem.cloud.points;
  fit_noisy_jets(points, Neighbours(points), problem.noise, problem.spacing, solution.refinement.normals, stages.cancel());
}

}  // namespace g3r
