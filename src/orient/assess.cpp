#include "orient/assess.h"

#include "base/number_text.h"
#include "orient/confidence.h"
#include "orient/polish.h"
#include "orient/walls.h"
#include "orient/wanted.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace g3r {
namespace {

std::vector<float> confidence_of_solution(const Problem& problem, const Solution& solution) {
  const Refinement& refined = solution.refinement;
  if (problem.noise > 0) {
    const Sums around = sums_over(problem.cloud.set.near(), solution.eta);
    return side_confidence(around.vectors, refined.normals, refined.strength, around.lengths);
  }
  const std::vector<double> areas = point_areas(problem.settings, problem.cloud.set.smoothed_spacing());
  return side_confidence(solution.eta, refined.normals, refined.strength, areas);
}

// The sides of points on open surfaces do not come from the equations, and their confidence neither.
void add_open_surfaces(const OpenSurfaces& surfaces, bool are_seen, std::vector<float>& confidence, Stats& stats) {
  if (surfaces.part.empty()) return;
  std::size_t open = 0;
  std::size_t agreed = 0;
  std::size_t unshown = 0;  // points whose side what is around does not show
  for (std::size_t i = 0; i < surfaces.part.size(); ++i) {
    if (!surfaces.is_open(i)) {
      confidence[i] *= surfaces.certainty[i];
      continue;
    }
    confidence[i] = static_cast<float>(both_agree(surfaces.certainty[i], surfaces.held[i]));
    ++open;
    agreed += surfaces.agrees[i];
    unshown += surfaces.certified[i] < kUndecided ? 1 : 0;
  }
  if (open == 0) return;
  const auto all = static_cast<double>(confidence.size());
  stats.open_share = static_cast<double>(open) / all;
  stats.warnings.push_back("open: " + percent(stats.open_share) +
                           (are_seen
                                ? " of the points are taken for open surfaces, with an inside or not, as they face what has seen them; "
                                : " of the points lie on surfaces without an inside; ") +
                           (agreed < open  ? "their sides do not agree everywhere"
                            : unshown == 0 ? "their sides are consistent"
                                           : "their sides are consistent, but the neighbours of " +
                                                 percent(static_cast<double>(unshown) / all) + " of the points do not confirm theirs"));
}

// Sides of closed surfaces that their field does not show to be right are worth less, those on open ones that do not agree nothing. Where
// noise hides walls, the field of one wall is right, and half of the points are on the other.
void certify_sides(const OpenSurfaces& surfaces, bool hides_walls, std::vector<float>& confidence) {
  for (std::size_t i = 0; i < surfaces.certified.size(); ++i) {
    const float least = surfaces.is_open(i) ? 0 : std::min(confidence[i], surfaces.uncertified);
    confidence[i] = least + (confidence[i] - least) * surfaces.certified[i];
  }
  if (!hides_walls) return;
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    if (!surfaces.is_open(i)) confidence[i] *= kUndecided;
  }
}

}  // namespace

Oriented assess(const Problem& problem, Solution solution, Stats& stats) {
  Oriented out;
  out.solution = std::move(solution);
  out.confidence = confidence_of_solution(problem, out.solution);
  const OpenSurfaces& surfaces = out.solution.open_surfaces;
  add_open_surfaces(surfaces, problem.cloud.set.views().known(), out.confidence, stats);
  const auto is_open = [&](std::size_t i) { return surfaces.is_open(i); };
  const auto share = [&](const auto& is_so) { return share_of_wanted(problem.known.wanted, problem.cloud.size(), is_so); };
  out.agreed = share([&](std::size_t i) { return is_open(i) && surfaces.agrees[i] != 0; });
  out.doubt = unsure_share(out.confidence, problem.known.wanted) + share(is_open);
  if (problem.noise > 0 && stats.open_share < 1 && !problem.cloud.set.views().known()) {
    out.about_walls = excess_about_walls(problem.cloud.set, out.solution.refinement.normals, problem.noise, problem.spacing);
  }
  const bool hides_walls = out.about_walls.is_two_walls();
  if (runs(problem, Step::kCertificate)) {
    certify_sides(surfaces, hides_walls, out.confidence);
    limit_to_evidence(problem.cloud.size(), out.confidence);
  }
  if (hides_walls) {
    stats.warnings.emplace_back(
        "two layers: the points lie about their surface as about two that are too close together for their noise: a wall that needs more "
        "points or less noise, or scans that have to be aligned");
  }
  if (stats.open_share == 1) stats.converged = true;  // no side and no direction comes from the equations
  if (!stats.converged) {
    stats.warnings.emplace_back("the solver did not reach its tolerance; normals may be less accurate");
  }
  summarise_sides(surfaces, out.confidence, {}, stats);
  return out;
}

void summarise_sides(const OpenSurfaces& surfaces, const std::vector<float>& confidence, const std::vector<std::uint8_t>& decided,
                     Stats& stats) {
  double sum = 0;
  std::size_t choices = 0;
  std::size_t doubtful = 0;  // a choice, unsure, or both
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    sum += static_cast<double>(confidence[i]);
    const bool is_choice = surfaces.is_choice(i) && (decided.empty() || decided[i] == 0);
    choices += is_choice ? 1 : 0;
    doubtful += is_choice || is_unsure(surfaces, confidence, i) ? 1 : 0;
  }
  const auto all = static_cast<double>(confidence.size());
  stats.confidence_mean = sum / all;
  stats.confidence_below_half = unsure_share(confidence);
  stats.undecided_share = static_cast<double>(choices) / all;
  stats.consistent = static_cast<double>(doubtful) / all <= kManyUnsure;
}

void warn_of_unsure(const OpenSurfaces& surfaces, const std::vector<float>& confidence, Stats& stats) {
  const double unsure = unsure_share(surfaces, confidence);
  if (unsure <= kManyUnsure) return;
  stats.warnings.push_back("orientation not consistent: " + percent(unsure) +
                           " of the points could face either way; the cloud may be open, very noisy or too sparse");
}

}  // namespace g3r
