#include "orient/solve_apart.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "cloud/sites.h"
#include "orient/crowded.h"
#include "orient/known_open.h"
#include "orient/open_surfaces.h"
#include "sum/fast_sum.h"

#include <algorithm>
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
  std::vector<double> around;
  for (std::uint32_t i = 0, k = 0; i < eta.size(); ++i) {
    if (k < some.size() && some[k] == i) {
      here.push_back(problem.cloud.points()[i]);
      ++k;
      continue;
    }
    others.push_back(problem.cloud.points()[i]);
    areas.push_back(eta[i]);
    around.push_back(problem.cloud.set.smoothed_spacing()[i]);
  }
  const FastSum field(others, narrowed(kBetweenSites * problem.spacing, around, problem.spacing), problem.settings.sums, stages.cancel());
  double sum = 0;
  for (const double w : field.winding_at(areas, here, stages.cancel())) sum += std::abs(w);
  return sum / static_cast<double>(here.size());
}

// Puts the solution of some of the points (ascending) into that of all.
void take(const std::vector<std::uint32_t>& some, const Solution& apart, Solution& all) {
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    all.eta[i] = apart.eta[k];
    all.refinement.normals[i] = apart.refinement.normals[k];
    all.refinement.strength[i] = apart.refinement.strength[k];
  }
  all.open_surfaces.put(some, apart.open_surfaces);
}

// Replaces a solution of all points, part by part.
class SolvedApart {
 public:
  SolvedApart(const Problem& problem, const Options& options, Stages& stages, Stats& stats, Solution& solution)
      : problem_(problem), options_(options), stages_(stages), stats_(stats), solution_(solution), all_converged_(stats.converged) {}

  void run() {
    std::map<std::uint32_t, std::vector<std::uint32_t>> parts = by_surface();
    if (parts.size() < 2) return;  // no open surface, or one that is all there is
    all_looked_open_ = parts.count(OpenSurfaces::kNone) == 0;
    for (const auto& [surface, points] : parts) {
      // What encloses no more than a bowl is not closed by itself either.
      if (surface != OpenSurfaces::kNone && solution_.open_surfaces.certainty[surface] > kMostOf) solve_open(points);
    }
    parts = by_surface();
    stats_.converged = parts.count(OpenSurfaces::kNone) == 0 || closed_converged(parts[OpenSurfaces::kNone]);
  }

 private:
  // The points of every open surface, and of everything else, ascending.
  [[nodiscard]] std::map<std::uint32_t, std::vector<std::uint32_t>> by_surface() const {
    std::map<std::uint32_t, std::vector<std::uint32_t>> parts;
    const std::vector<std::uint32_t>& part = solution_.open_surfaces.part;
    for (std::uint32_t i = 0; i < part.size(); ++i) parts[part[i]].push_back(i);
    return parts;
  }

  // Whether the others take part in the equations of some points, as far as the sums show it.
  [[nodiscard]] bool are_disturbed(const std::vector<std::uint32_t>& some) const {
    return some.size() >= kFewestSites && winding_of_others(problem_, some, solution_.eta, stages_) > kContinuedAccuracy;
  }

  // One that is open by itself too stays as it is.
  void solve_open(const std::vector<std::uint32_t>& some) {
    if (!are_disturbed(some)) return;
    const Solution apart = solve(part_of(problem_, some, options_), options_, stages_, stats_);
    if (!apart.open_surfaces.part.empty()) return;
    found_closed_ &= stats_.converged;
    take(some, apart, solution_);
  }

  // What is closed, and that is all of `some`, has to solve the equations.
  bool closed_converged(const std::vector<std::uint32_t>& some) {
    if (some.size() == problem_.cloud.size()) return found_closed_ && (all_looked_open_ || all_converged_);
    if (!are_disturbed(some)) return found_closed_ && all_converged_;
    take(some, solve(part_of(problem_, some, options_), options_, stages_, stats_), solution_);
    return stats_.converged;
  }

  const Problem& problem_;
  const Options& options_;
  Stages& stages_;
  Stats& stats_;
  Solution& solution_;
  bool all_converged_;            // the solve of everything
  bool found_closed_ = true;      // and those of parts that looked open
  bool all_looked_open_ = false;  // so that all that is closed was solved for again
};

// The points that are known to be open as they are known, and the others without them.
Solution solve_beside(const std::vector<std::uint32_t>& open, const Problem& problem, const Options& options, Stages& stages,
                      Stats& stats) {
  std::vector<std::uint32_t> others;
  for (std::uint32_t i = 0, k = 0; i < problem.cloud.size(); ++i) {
    if (k < open.size() && open[k] == i) {
      ++k;
    } else {
      others.push_back(i);
    }
  }
  const Solution closed = solve_parts(part_of(problem, others, options), options, stages, stats);
  Solution known = as_known_open(part_of(problem, open, options), stages);
  if (!closed.refinement.strength.empty()) {  // as strong as the typical one of the others, by which these are measured
    std::fill(known.refinement.strength.begin(), known.refinement.strength.end(), median(closed.refinement.strength));
  }
  Solution solution{std::vector<Vec3>(problem.cloud.size()), {}, {}};
  solution.refinement.normals.resize(problem.cloud.size());
  solution.refinement.strength.resize(problem.cloud.size());
  solution.open_surfaces.certified.resize(problem.cloud.size());
  solution.open_surfaces.uncertified = closed.open_surfaces.uncertified;
  take(open, known, solution);
  take(others, closed, solution);
  return solution;
}

}  // namespace

Solution solve_parts(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const std::vector<std::uint32_t> open = known_open_points(problem);
  if (open.size() == problem.cloud.size()) return as_known_open(problem, stages);
  if (!open.empty()) return solve_beside(open, problem, options, stages, stats);
  Solution solution = solve(problem, options, stages, stats);
  if (runs(problem, Step::kApart)) SolvedApart(problem, options, stages, stats, solution).run();
  return solution;
}

}  // namespace g3r
