#include "orient/noise_choice.h"

#include "cloud/constants.h"
#include "cloud/noise.h"
#include "orient/confidence.h"
#include "orient/noise_settings.h"
#include "orient/separate_walls.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace g3r {
namespace {

// Points up to which shape looks like noise, so that none is tried too: with more it costs time and is never taken.
constexpr std::size_t kFewPoints = 2500;

bool may_try_noises(const Problem& problem, const Options& options) {
  const bool on_points = problem.line_distance.empty();  // sites have a noise of their own
  const bool sides_known = problem.cloud.set.views().known();
  return on_points && !sides_known && options.epsilon.unit == Length::Unit::kAuto && options.noise.unit == Length::Unit::kAuto &&
         options.schedule.empty() && runs(problem, Step::kNoise) && runs(problem, Step::kNoiseChoice);
}

}  // namespace

std::vector<OtherNoise> other_noises(const Problem& problem, const Oriented& found) {
  if (found.doubt < kDoubtful) return {};
  const PointSet& set = problem.cloud.set;
  const double scatter = largest_scatter(set);
  const double least = noise_of_clean_widths() * problem.spacing;  // less blurs no less, and leaves more unsure
  const double unsure = found.doubt - found.agreed;
  // A scatter of kWider times the estimate speaks against it. What is tried is kWider times the larger of both: kernels have to hide all of
  // it.
  std::vector<OtherNoise> noises;
  const double rounding = rounding_deviation(set);
  if (rounding > problem.noise) noises.push_back({rounding});
  if (kWider * scatter <= least && unsure < kDoubtful) return noises;
  if (set.size() <= kFewPoints && problem.noise > rounding_noise(set)) noises.push_back({0});
  if (scatter > kWider * problem.noise) {
    noises.push_back({std::max(kWider * scatter, least)});
  } else if (problem.noise > 0 && unsure >= kDoubtful) {
    // More than the points speak for hides thin walls and all doubt about them: not many may stay unsure of those that are.
    noises.push_back({kWider * std::max(scatter, problem.noise), kManyUnsure});
  }
  return noises;
}

Attempt with_best_noise(Attempt first, const PointsView& points, const Options& options, Stages& stages) {
  if (!may_try_noises(first.problem, options)) return first;
  const double estimate = first.problem.noise;
  const double first_doubt = first.oriented.doubt;
  Attempt best = separate_walls(std::move(first), points, options, stages);
  const double doubt = best.oriented.doubt;
  const bool walls_explain_it = best.problem.noise < estimate && doubt <= kClearlyLess * first_doubt;
  const bool has_walls = walls_explain_it || best.oriented.about_walls.is_two_walls();
  // Kernels for this estimate, or those of clean clouds, hide so much noise, and merge what it merges.
  const double hidden_anyway = std::max(estimate, noise_of_clean_widths() * best.problem.spacing);
  for (const OtherNoise& other : other_noises(best.problem, best.oriented)) {
    if (has_walls && other.noise > best.problem.noise) continue;
    Attempt tried = attempt(with_noise(best.problem, other.noise, options), points, options, stages);
    const double most = std::min(other.most_doubt * doubt, best.oriented.doubt);
    const bool merges_walls = next_hidden_noise(other.noise) > hidden_anyway && tried.oriented.about_walls.may_be_two_walls();
    if (tried.oriented.doubt <= most && !merges_walls) best = std::move(tried);
  }
  return best;
}

}  // namespace g3r
