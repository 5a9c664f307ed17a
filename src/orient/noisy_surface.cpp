#include "orient/noisy_surface.h"

#include "base/vector.h"
#include "cloud/clusters.h"
#include "cloud/constants.h"
#include "cloud/morton.h"
#include "orient/certified_sides.h"
#include "orient/clustered_polish.h"
#include "orient/confidence.h"
#include "orient/facet_normals.h"
#include "orient/facets.h"
#include "orient/noise_settings.h"
#include "orient/noisy_jets.h"
#include "orient/open_to_views.h"
#include "orient/planes.h"
#include "orient/polish.h"
#include "orient/projection.h"
#include "orient/site_parts.h"
#include "solve/part_system.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace g3r {
namespace {

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

}  // namespace

bool is_projected(const Problem& problem) {
  const double left = projected_noise(problem.noise, problem.spacing);
  const bool halves_variance = left * left <= kClearlyLess * problem.noise * problem.noise;
  const bool on_points = problem.line_distance.empty();
  return problem.noise > 0 && on_points && halves_variance && runs(problem, Step::kPolish) && runs(problem, Step::kProjection);
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
    const Clusters clusters = cluster_points(points, kResolved * s.polish.epsilon.typical(), here);  // which the kernels see as one
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
  const double noise = std::max(problem.noise, problem.direction_noise);
  const bool is_each_alone = !is_seen_in_noise(problem) || problem.noise_together == 1;  // the noise of each point, as these fits take it
  if (noise == 0 || !is_each_alone || !runs(problem, Step::kPolish) || !runs(problem, Step::kNoisyJets)) return;
  fit_noisy_jets(problem.cloud.set, noise, problem.known.wanted, solution.refinement.normals, stages.cancel());
  // Facets whose points scatter less than the noise of all by more than a step, to which both are known, are chance, or beside what is
  // noisy.
  if (noise >= kLevelRatio * problem.scatter || !runs(problem, Step::kPlanes)) return;
  std::vector<std::uint8_t> proven(problem.cloud.size(), 0);
  fit_planes(problem.cloud.set, problem.scatter, proven, solution.refinement.normals);
  if (!runs(problem, Step::kFacets)) return;
  const Facets facets = find_facets(problem.cloud.set, proven, solution.refinement.normals, problem.scatter, problem.known.wanted);
  follow_facets(problem.cloud.set, facets, problem.known.wanted, solution.refinement.normals);
}

}  // namespace g3r
