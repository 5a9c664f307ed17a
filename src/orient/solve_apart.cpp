#include "orient/solve_apart.h"

#include "cloud/constants.h"
#include "cloud/sites.h"
#include "orient/confidence.h"
#include "orient/open_surfaces.h"
#include "sum/fast_sum.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace g3r {
namespace {

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
    solution.open_surfaces.held[i] = apart.open_surfaces.held.empty() ? 1 : apart.open_surfaces.held[k];
  }
  return stats.converged;
}

void solve_open_surfaces_apart(const Problem& problem, const Options& options, Stages& stages, Stats& stats, Solution& solution) {
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

}  // namespace

Solution solve_parts(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  Solution solution = solve(problem, options, stages, stats);
  if (runs(problem, Step::kApart)) solve_open_surfaces_apart(problem, options, stages, stats, solution);
  return solution;
}

}  // namespace g3r
