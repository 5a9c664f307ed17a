#include "orient/solution.h"

#include "base/vector.h"
#include "baselines/baseline.h"
#include "cloud/clusters.h"
#include "orient/certified_sides.h"
#include "orient/clean_surface.h"
#include "orient/clustered_polish.h"
#include "orient/coarse_to_fine.h"
#include "orient/polish.h"
#include "solve/dense_solver.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "sum/fast_sum.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <algorithm>
#include <utility>

namespace g3r {
namespace {

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

Solution solve_by_steps(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  Solved solved = solve_coarse_to_fine(problem.cloud.points(), s, stages, relative_spacing(problem, options), problem.known.gradient);
  record(s, solved.result, stats);
  return {std::move(solved.result.eta), std::move(solved.refinement), {}};
}

// Area vectors, and their refinement unless its width is 0.
Solution solve_equations(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const std::vector<Vec3>& points = problem.cloud.points();
  stages.begin("solve");
  if (!s.dense) return solve_by_steps(problem, options, stages, stats);
  const HarmonicValues u = evaluate_harmonics(s.harmonics, points);
  DenseResult dense = solve_dense(points, s.epsilon.typical(), u, options.condition_number, stages.cancel());
  stats.condition_number = dense.condition_number;
  if (dense.eta.empty()) {
    if (options.solver == Solver::kDense) {
      throw InvalidInput(
          "the normal matrix is singular: points are too close together for epsilon, or these harmonics are too few; use the solver cg, or "
          "harmonics of degree:0-2");
    }
    stats.solver = name_of(Solver::kConjugateGradient);
    return solve_by_steps(problem, options, stages, stats);
  }
  stats.converged = true;
  Solution solution;
  solution.eta = std::move(dense.eta);
  stages.begin("refine");
  if (s.refinement_width.typical() == 0) return solution;
  FastSum sum(points, Widths(s.refinement_width.typical()), s.sums, stages.cancel());
  solution.refinement = refine_normals(sum, solution.eta);
  return solution;
}

bool has_open_part(const OpenSurfaces& surfaces) {
  return std::any_of(surfaces.part.begin(), surfaces.part.end(), [](std::uint32_t part) { return part != OpenSurfaces::kNone; });
}

// Points on open surfaces get area vectors along the normals found for them.
void set_open_areas(const OpenSurfaces& surfaces, const PointSet& set, const std::vector<Vec3>& normals, std::vector<Vec3>& eta) {
  const std::vector<double>& spacing = set.local_spacing();
  for (std::size_t i = 0; i < surfaces.part.size(); ++i) {
    if (!surfaces.is_open(i)) continue;
    for (std::size_t a = 0; a < 3; ++a) eta[i][a] = spacing[i] * spacing[i] * normals[i][a];
  }
}

bool any_turned(const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (vector::dot(before[i], after[i]) < 0) return true;
  }
  return false;
}

// Exact points as dense as they lie; others no denser than is typical, and counted as the area that they stand for.
PolishCloud polish_cloud(const Problem& problem, const Options& options) {
  const PointSet& set = problem.cloud.set;
  const bool is_exact = problem.is_clean() && runs(problem, Step::kLocalWidths);
  const std::vector<double> relative = is_exact ? problem.known.relative_spacing : relative_spacing(problem, options);
  const std::vector<double> local = is_exact ? set.smoothed_spacing() : scaled(problem.spacing, relative);
  return {set.points(), local, point_areas(problem.settings, local), relative};
}

Solution solve_on_points(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const PointSet& set = problem.cloud.set;
  Solution solution = solve_equations(problem, options, stages, stats);
  if (s.refinement_width.typical() == 0) solution.refinement.normals = normalised(solution.eta);
  if (!runs(problem, Step::kPolish)) return solution;
  std::vector<Vec3>().swap(solution.eta);  // the polish starts from the refinement
  Polished polished = polish(polish_cloud(problem, options), s, std::move(solution.refinement), stages);
  solution = {std::move(polished.eta), std::move(polished.refinement), {}};
  std::vector<Vec3>& normals = solution.refinement.normals;
  const auto find_open = [&](std::vector<Vec3>& sides) {
    if (!runs(problem, Step::kOpenSurfaces)) return OpenSurfaces{};
    return find_open_surfaces(set, problem.noise, s.sums, sides, stages.cancel());
  };
  OpenSurfaces surfaces = find_open(normals);
  if (has_open_part(surfaces)) {
    set_open_areas(surfaces, set, normals, solution.eta);
    if (problem.is_clean()) fit_directions(problem, normals);
  } else if (problem.is_clean()) {
    const std::vector<Vec3> before = normals;
    fit_clean_surface(problem, solution.eta, normals, stages);
    // Facets and creases may have found other sides, which the certificate has not seen.
    if (!surfaces.part.empty() || surfaces.is_turned) {
      surfaces = find_open(normals);
    } else if (!surfaces.certified.empty() && any_turned(before, normals)) {
      surfaces.certified = certified_sides(set, problem.noise, s.sums, normals, stages.cancel());
    }
  }
  solution.open_surfaces = std::move(surfaces);
  return solution;
}

Refinement solve_clusters(const Clusters& clusters, const std::vector<double>& spacing, const Settings& s, Stages& stages, Stats& stats) {
  stages.begin("solve");
  FastSum sum(clusters.points, local_widths(s.epsilon, s, spacing), s.first_sums, stages.cancel());
  const std::vector<double> roots = clusters.roots();
  EnergySystem system(sum, 0, s.winding_weight, roots);
  IterativeResult result = solve_iteratively(system, s.schedule, s.tolerance, {},
                                             [&](int step, int steps, double) { stages.progress(static_cast<double>(step) / steps); });
  record(s, result, stats);
  stages.begin("refine");
  FastSum wide(clusters.points, local_widths(s.refinement_width, s, spacing), s.sums, stages.cancel());
  return refine_normals(wide, system.to_areas(std::move(result.eta)));
}

// Where the kernels are so wide that they see groups of points: the same equations on one point per group, whose area vectors are equal
// but for the areas that they stand for. The refinement is evaluated at every point.
Solution solve_on_clusters(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const PointSet& set = problem.cloud.set;
  const std::vector<double> relative = relative_spacing(problem, options);
  const Clusters clusters = cluster_points(set.points(), s.cluster_side, relative);
  const std::vector<double> spacing = scaled(problem.spacing, clusters.relative_spacing);
  Refinement first = solve_clusters(clusters, spacing, s, stages, stats);
  Polished polished = polish_clusters({set.points(), relative, clusters}, s, std::move(first), stages);
  Solution solution{std::move(polished.eta), std::move(polished.refinement), {}};
  if (!runs(problem, Step::kOpenSurfaces)) return solution;
  solution.open_surfaces = find_open_surfaces(problem.cloud.set, problem.noise, s.sums, solution.refinement.normals, stages.cancel());
  if (!solution.open_surfaces.part.empty())
    set_open_areas(solution.open_surfaces, problem.cloud.set, solution.refinement.normals, solution.eta);
  return solution;
}

}  // namespace

Solution solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (problem.baseline) return solve_by_baseline(problem, stages, stats);
  if (problem.settings.cluster_side > 0) return solve_on_clusters(problem, options, stages, stats);
  return solve_on_points(problem, options, stages, stats);
}

}  // namespace g3r
