#include "orient/solve_on_sites.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/sites.h"
#include "cloud/spacing.h"
#include "orient/agreement.h"
#include "orient/certificate.h"
#include "orient/open_surfaces.h"
#include "orient/site_parts.h"
#include "orient/solve_apart.h"
#include "solve/part_system.h"
#include "solve/refine.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace g3r {
namespace {

// Normals of the points from those of the sites, and from their field where it has fewer sites than points.
Refinement refine(const Problem& problem, const Problem& coarse, const Sites& sites, const Solution& solved, Stages& stages) {
  std::map<double, std::vector<std::uint32_t>> alike;
  for (std::uint32_t i = 0; i < problem.cloud.size(); ++i) alike[problem.line_distance[i]].push_back(i);
  Refinement out{std::vector<Vec3>(problem.cloud.size()), std::vector<double>(problem.cloud.size())};
  for (const auto& [distance, some] : alike) {
    std::vector<std::uint32_t> of_sites = values_at(some, sites.site_of);
    const std::vector<Vec3> eta = values_at(of_sites, solved.eta);
    Refinement here;
    if (distance == 0) {
      here = {values_at(of_sites, solved.refinement.normals), values_at(of_sites, solved.refinement.strength)};
    } else {
      std::sort(of_sites.begin(), of_sites.end());
      of_sites.erase(std::unique(of_sites.begin(), of_sites.end()), of_sites.end());
      const double width = kBetweenSites * typical_spacing(values_at(of_sites, sites.spacing()));
      const FastSum field(sites.points(), Widths(width), coarse.settings.sums, stages.cancel());
      const std::vector<Vec3> targets = values_at(some, problem.cloud.points());
      here = unit_normals(field.winding_gradient_at(solved.eta, targets, stages.cancel()), eta);
    }
    for (std::size_t k = 0; k < some.size(); ++k) {
      out.normals[some[k]] = here.normals[k];
      out.strength[some[k]] = here.strength[k];
    }
  }
  return out;
}

// Whether most of the points in lines are on open surfaces.
bool are_lines_open(const Problem& problem, const OpenSurfaces& surfaces) {
  std::size_t in_lines = 0;
  std::size_t open = 0;
  for (std::size_t i = 0; i < problem.line_distance.size(); ++i) {
    if (problem.line_distance[i] == 0) continue;
    ++in_lines;
    open += surfaces.is_open(i) ? 1 : 0;
  }
  return 2 * open > in_lines;
}

// Whether the mean jump defect of one solution at the sites is less than that of another.
bool jumps_better(const Problem& problem, const Solution& one, const Solution& other, Stages& stages) {
  const Sites sites = place_sites(problem.cloud.set, problem.line_distance);
  std::vector<std::vector<Vec3>> normals;
  for (const Solution* solution : {&one, &other}) normals.push_back(at_sites(sites, solution->refinement.normals));
  const JumpDefects defects = jump_defects(sites, std::move(normals), problem.settings.sums, stages.cancel());
  std::vector<std::uint32_t> all(sites.size());
  std::iota(all.begin(), all.end(), std::uint32_t{0});
  const auto sum = [&](std::size_t h) { return mean_over(all, defects.all[h]) + mean_over(all, defects.own[h]); };
  return sum(0) < sum(1);
}

}  // namespace

Solution solve_on_sites(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const std::vector<Vec3>& points = problem.cloud.points();
  const Sites sites = place_sites(problem.cloud.set, problem.line_distance);
  const Problem coarse = on_sites(problem, sites, options);
  const Solution solved = solve_parts(coarse, options, stages, stats);
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
    out.open_surfaces.held.push_back(solved.open_surfaces.held[s]);
  }
  out.refinement = refine(problem, coarse, sites, solved, stages);
  return out;
}

Solution solve_with_lines(Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (problem.is_lines()) return solve_on_sites(problem, options, stages, stats);
  Stats of_sites = stats;
  Solution on_points = solve_parts(problem, options, stages, stats);
  if (are_lines_open(problem, on_points.open_surfaces)) {
    Solution on_sites = solve_on_sites(problem, options, stages, of_sites);
    if (jumps_better(problem, on_sites, on_points, stages)) {
      stats = std::move(of_sites);
      return on_sites;
    }
  }
  problem.line_distance.clear();
  return on_points;
}

}  // namespace g3r
