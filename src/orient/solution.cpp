#include "orient/solution.h"

#include "base/vector.h"
#include "baselines/baseline.h"
#include "cloud/canonical_cloud.h"
#include "cloud/clusters.h"
#include "cloud/sites.h"
#include "cloud/spacing.h"
#include "orient/clustered_polish.h"
#include "orient/coarse_to_fine.h"
#include "orient/confidence.h"
#include "orient/creases.h"
#include "orient/facets.h"
#include "orient/jets.h"
#include "orient/noisy_jets.h"
#include "orient/planes.h"
#include "orient/polish.h"
#include "orient/projection.h"
#include "solve/dense_solver.h"
#include "solve/energy_system.h"
#include "solve/iterative_solver.h"
#include "solve/part_system.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace g3r {
namespace {

constexpr double kMinMinority = 1e-3;  // share of the points on a doubtful side, from which facets or projected points are solved for
constexpr double kChance = 1.12;       // of the typical spacing, up to which noise alone may have scattered points so far apart
constexpr int kMostRounds = 3;         // of facets, as points on none come right after those on one; and of projections

bool runs(const Problem& problem, Step step) { return !contains(problem.settings.without, step); }

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

// How many times as far apart the points are as typical ones, 1 at least; kernels are as much wider. Unless the width is given: then only
// as far as they have been thinned.
std::vector<double> relative_spacing(const Problem& problem, const Options& options) {
  const bool is_free = problem.settings.method == Method::kEnergy && options.epsilon.unit == Length::Unit::kAuto;
  const std::vector<double>& thinned = problem.known.relative_spacing;
  if (!is_free || !runs(problem, Step::kLocalWidths)) return thinned;
  std::vector<double> relative = spacing_before_thinning(problem.cloud.set.smoothed_spacing(), thinned);
  const double typical = (problem.is_clean() ? 1 : kChance) * problem.spacing;
  for (double& h : relative) h = std::max(1.0, h / typical);
  for (std::size_t i = 0; i < thinned.size(); ++i) relative[i] *= thinned[i];
  return relative;
}

// Area vectors, and their refinement unless its width is 0.
Solution solve_equations(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  const std::vector<Vec3>& points = problem.cloud.points();
  stages.begin("solve");
  if (!s.dense) {
    Solved solved = solve_coarse_to_fine(points, s, stages, relative_spacing(problem, options), problem.known.gradient);
    record(s, solved.result, stats);
    return {std::move(solved.result.eta), std::move(solved.refinement), {}};
  }
  const HarmonicValues u = evaluate_harmonics(s.harmonics, points);
  DenseResult dense = solve_dense(points, s.epsilon.typical(), u, options.condition_number, stages.cancel());
  stats.converged = true;
  stats.condition_number = dense.condition_number;
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

// The points whose sides come from the equations, ascending: not those on open surfaces, nor on others whose field is not at rest.
std::vector<std::uint32_t> solved_points(const Solution& solution) {
  const OpenSurfaces& surfaces = solution.open_surfaces;
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < solution.eta.size(); ++i) {
    const bool is_solved = surfaces.part.empty() || (surfaces.part[i] == OpenSurfaces::kNone && surfaces.certainty[i] > kUndecided);
    if (is_solved) some.push_back(i);
  }
  return some;
}

// Points on open surfaces get area vectors along the normals found for them.
void set_open_areas(const OpenSurfaces& surfaces, const PointSet& set, const std::vector<Vec3>& normals, std::vector<Vec3>& eta) {
  const std::vector<double>& spacing = set.local_spacing();
  for (std::size_t i = 0; i < surfaces.part.size(); ++i) {
    if (!surfaces.is_open(i)) continue;
    for (std::size_t a = 0; a < 3; ++a) eta[i][a] = spacing[i] * spacing[i] * normals[i][a];
  }
}

// Where the points of a cloud's facets disagree about their sides, every facet gets one, and the other points their normals from the field
// of what the facets have become. `fit` proves normals; `proven`: those it has.
template <typename Fit>
void agree_on_facets(const Problem& problem, const std::vector<std::uint8_t>& proven, const Fit& fit, std::vector<Vec3>& eta,
                     std::vector<Vec3>& normals, Stages& stages) {
  const PointSet& set = problem.cloud.set;
  const Settings& s = problem.settings;
  for (int round = 0; round < kMostRounds; ++round) {
    const Facets facets = find_facets(set, proven, normals, problem.known.wanted);
    if (minority_share(facets, normals) < kMinMinority) return;
    make_room_for_sums(set);
    choose_facet_sides(set, s, facets, eta, normals, stages);
    FastSum sum(set.points(), local_widths(s.polish_width, s, set.smoothed_spacing()), s.sums, stages.cancel());
    const Refinement refined = refine_normals(sum, eta);
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (facets.of[i] == Facets::kNone) normals[i] = refined.normals[i];
    }
    fit();
  }
}

// The directions of a clean cloud, where its points prove what the surface is. Returns for which they do.
std::vector<std::uint8_t> fit_directions(const Problem& problem, std::vector<Vec3>& normals) {
  std::vector<std::uint8_t> proven(normals.size(), 0);
  if (runs(problem, Step::kJets)) proven = fit_jets(problem.cloud.set, normals);
  if (runs(problem, Step::kPlanes)) fit_planes(problem.cloud.set, problem.scatter, proven, normals);
  return proven;
}

// The normals of a clean cloud: directions, creases, and the sides of facets.
void fit_surface(const Problem& problem, std::vector<Vec3>& eta, std::vector<Vec3>& normals, Stages& stages) {
  std::vector<std::uint8_t> proven;
  const auto fit = [&] { proven = fit_directions(problem, normals); };
  fit();
  if (runs(problem, Step::kCreases) && sharpen_creases(problem.cloud.set, normals)) fit();
  if (runs(problem, Step::kFacets)) agree_on_facets(problem, proven, fit, eta, normals, stages);
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
  if (s.polish_steps == 0) return solution;
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
    fit_surface(problem, solution.eta, normals, stages);
    // Facets and creases may have found other sides, which the certificate has not seen.
    if (!surfaces.part.empty()) {
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

// Where the samples are lines: on sites as far apart as the lines, which are a surface. The refinement is evaluated at every point.
Solution solve_on_sites(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const std::vector<Vec3>& points = problem.cloud.points();
  const Sites sites = place_sites(problem.cloud.set, problem.line_distance);
  const Problem coarse = on_sites(problem, sites, options);
  Solution solved = solve(coarse, options, stages, stats);
  solve_open_surfaces_apart(coarse, options, stages, stats, solved);
  Solution out;
  out.open_surfaces.uncertified = solved.open_surfaces.uncertified;
  out.eta.resize(points.size());
  std::vector<double> members(sites.size(), 0);
  for (const std::uint32_t s : sites.site_of) ++members[s];
  std::vector<std::uint32_t> first(sites.size(), OpenSurfaces::kNone);  // point of every part
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::uint32_t s = sites.site_of[i];
    out.eta[i] = vector::scale(solved.eta[s], 1 / members[s]);
    if (!solved.open_surfaces.certified.empty()) out.open_surfaces.certified.push_back(solved.open_surfaces.certified[s]);
    if (solved.open_surfaces.part.empty()) continue;
    const std::uint32_t part = solved.open_surfaces.part[s];
    if (part != OpenSurfaces::kNone) first[part] = std::min(first[part], i);
    out.open_surfaces.part.push_back(part == OpenSurfaces::kNone ? part : first[part]);
    out.open_surfaces.certainty.push_back(solved.open_surfaces.certainty[s]);
    out.open_surfaces.agrees.push_back(solved.open_surfaces.agrees[s]);
  }
  const FastSum field(sites.points(), Widths(kBetweenSites * coarse.spacing), coarse.settings.sums, stages.cancel());
  out.refinement = unit_normals(field.winding_gradient_at(solved.eta, points, stages.cancel()), out.eta);
  return out;
}

// Mean size of the winding number at some points (ascending) of all the others: how much of the equations there is theirs.
double winding_of_others(const Problem& problem, const std::vector<std::uint32_t>& some, const std::vector<Vec3>& eta, Stages& stages) {
  std::vector<Vec3> others;
  std::vector<Vec3> areas;
  std::vector<Vec3> here;
  for (std::uint32_t i = 0, k = 0; i < eta.size(); ++i) {
    if (k < some.size() && some[k] == i) {
      here.push_back(problem.cloud.points()[i]);
      ++k;
      continue;
    }
    others.push_back(problem.cloud.points()[i]);
    areas.push_back(eta[i]);
  }
  const FastSum field(others, Widths(kBetweenSites * problem.spacing), problem.settings.sums, stages.cancel());
  double sum = 0;
  for (const double w : field.winding_at(areas, here, stages.cancel())) sum += std::abs(w);
  return sum / static_cast<double>(here.size());
}

// Solves for some points (ascending) without the others, unless the sums do not show that these take part in their equations. An open
// surface that is one by itself too stays as it is. Returns false if what it took did not converge.
bool solve_apart(const Problem& problem, const std::vector<std::uint32_t>& some, bool is_open, const Options& options, Stages& stages,
                 Stats& stats, Solution& solution) {
  if (some.size() < kFewestSites || winding_of_others(problem, some, solution.eta, stages) <= kContinuedAccuracy) return true;
  const Solution apart = solve(part_of(problem, some, options), options, stages, stats);
  if (is_open && !apart.open_surfaces.part.empty()) return true;
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    solution.eta[i] = apart.eta[k];
    solution.refinement.normals[i] = apart.refinement.normals[k];
    solution.refinement.strength[i] = apart.refinement.strength[k];
    solution.open_surfaces.certified[i] = apart.open_surfaces.certified[k];
    const bool open = !apart.open_surfaces.part.empty() && apart.open_surfaces.part[k] != OpenSurfaces::kNone;
    solution.open_surfaces.part[i] = open ? some[apart.open_surfaces.part[k]] : OpenSurfaces::kNone;
    solution.open_surfaces.certainty[i] = apart.open_surfaces.certainty.empty() ? 1 : apart.open_surfaces.certainty[k];
    solution.open_surfaces.agrees[i] = apart.open_surfaces.agrees.empty() ? 0 : apart.open_surfaces.agrees[k];
  }
  return stats.converged;
}

}  // namespace

Solution solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (problem.baseline) return solve_by_baseline(problem, stages, stats);
  if (problem.line_distance > 0) return solve_on_sites(problem, options, stages, stats);
  if (problem.settings.cluster_side > 0) return solve_on_clusters(problem, options, stages, stats);
  return solve_on_points(problem, options, stages, stats);
}

void solve_open_surfaces_apart(const Problem& problem, const Options& options, Stages& stages, Stats& stats, Solution& solution) {
  if (problem.line_distance > 0 || !runs(problem, Step::kApart)) return;  // of lines, solve() has done it, on the sites
  std::map<std::uint32_t, std::vector<std::uint32_t>> parts;
  const auto collect = [&] {
    parts.clear();
    for (std::uint32_t i = 0; i < solution.open_surfaces.part.size(); ++i) parts[solution.open_surfaces.part[i]].push_back(i);
  };
  collect();
  if (parts.size() < 2) return;  // no open surface, or one that is all there is
  bool converged = true;         // what is open does not solve the equations, and does not have to
  for (const auto& [surface, points] : parts) {
    // What encloses nothing is not closed by itself either.
    const bool may_be_closed = surface != OpenSurfaces::kNone && solution.open_surfaces.certainty[surface] > kUndecided;
    if (may_be_closed) converged &= solve_apart(problem, points, true, options, stages, stats, solution);
  }
  collect();
  if (parts.size() > 1 && parts.count(OpenSurfaces::kNone) > 0) {
    converged &= solve_apart(problem, parts[OpenSurfaces::kNone], false, options, stages, stats, solution);
  }
  stats.converged = converged;
}

bool is_projected(const Problem& problem) {
  const double left = projected_noise(problem.noise, problem.spacing);
  const bool halves_variance = 2 * left * left <= problem.noise * problem.noise;
  const bool on_points = !problem.baseline && problem.line_distance == 0 && problem.settings.polish_steps > 0;
  return problem.noise > 0 && on_points && halves_variance && runs(problem, Step::kProjection);
}

bool polish_projected(const Problem& problem, const Options& options, Stages& stages, Solution& solution) {
  if (!is_projected(problem)) return false;
  const std::vector<std::uint32_t> some = solved_points(solution);
  if (some.size() < kFewestSites) return false;
  const bool are_all = some.size() == problem.cloud.size();
  const PointSet set = are_all ? problem.cloud.set : PointSet(values_at(some, problem.cloud.points()));
  const std::vector<double> relative = values_at(some, relative_spacing(problem, options));
  const std::vector<double> spacing = scaled(problem.spacing, relative.empty() ? std::vector<double>{1} : relative);
  const Settings s = after_projection(problem.settings);
  Refinement refined{values_at(some, solution.refinement.normals), values_at(some, solution.refinement.strength)};
  bool has_converged = false;
  for (int round = 0; round < kMostRounds && !has_converged; ++round) {
    std::vector<Vec3> points = project_points(set.points(), set.tree(), refined.normals, problem.noise, spacing, stages.cancel());
    make_room_for_sums(set);
    const std::vector<std::uint32_t> order = morton_order(points);  // that clusters and sums ask for
    points = values_at(order, points);
    const std::vector<double> here = values_at(order, relative);
    // Kernels of width e see what is within 2 e as one.
    const Clusters clusters = cluster_points(points, 2 * s.polish_epsilon.typical(), here);
    Refinement start = mean_of_clusters(clusters, {values_at(order, refined.normals), values_at(order, refined.strength)});
    const Polished polished = polish_clusters({points, here, clusters}, s, std::move(start), stages);
    std::size_t turned = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::uint32_t i = order[k];
      turned += vector::dot(refined.normals[i], polished.refinement.normals[k]) < 0 ? 1 : 0;
      refined.normals[i] = polished.refinement.normals[k];
      refined.strength[i] = polished.refinement.strength[k];
      solution.eta[some[i]] = polished.eta[k];
    }
    has_converged = static_cast<double>(turned) < kMinMinority * static_cast<double>(order.size());
  }
  for (std::size_t k = 0; k < some.size(); ++k) {
    solution.refinement.normals[some[k]] = refined.normals[k];
    solution.refinement.strength[some[k]] = refined.strength[k];
  }
  std::vector<float>& certified = solution.open_surfaces.certified;
  if (certified.empty()) return true;
  const std::vector<float> shown = certified_sides(set, problem.noise, s.sums, refined.normals, stages.cancel());
  for (std::size_t k = 0; k < some.size(); ++k) certified[some[k]] = shown[k];
  return true;
}

void fit_noisy_surface(const Problem& problem, Stages& stages, Solution& solution) {
  const double noise = std::max(problem.noise, problem.view_noise);
  if (problem.baseline || noise == 0 || problem.settings.polish_steps == 0 || !runs(problem, Step::kNoisyJets)) return;
  fit_noisy_jets(problem.cloud.set, noise, problem.known.wanted, solution.refinement.normals, stages.cancel());
  std::vector<std::uint8_t> none(problem.cloud.size(), 0);
  if (problem.noise > 0 && problem.scatter > 0 && runs(problem, Step::kPlanes))
    fit_planes(problem.cloud.set, problem.scatter, none, solution.refinement.normals);
}

}  // namespace g3r
