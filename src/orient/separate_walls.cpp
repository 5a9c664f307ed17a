#include "orient/separate_walls.h"

#include "cloud/constants.h"
#include "orient/confidence.h"
#include "orient/noise_settings.h"
#include "orient/noisy_jets.h"
#include "orient/walls.h"

#include <cmath>
#include <optional>
#include <utility>

namespace g3r {
namespace {

// The walls that were found, for noise of so much.
PlacesOnWalls walls_of(const Attempt& found, double noise) {
  return fit_places(found.problem.cloud.set, found.oriented.solution.refinement.normals, noise, found.problem.spacing);
}

}  // namespace

double next_hidden_noise(double noise) { return noise / std::sqrt(kWider); }

Attempt separate_walls(Attempt found, const PointsView& points, const Options& options, Stages& stages) {
  const double noise = found.problem.noise;
  const bool is_open = found.stats.open_share > 0;  // and has no walls
  bool hides = found.oriented.about_walls.is_two_walls();
  if (noise == 0 || is_open) return found;
  if (found.oriented.doubt < kDoubtful && !hides) return found;
  const double least = noise_of_clean_widths() * found.problem.spacing;
  const PlacesOnWalls first = walls_of(found, noise);
  double before = misfit(first);
  std::optional<Attempt> separated;
  for (double hidden = next_hidden_noise(noise); before > 1 && hidden > least; hidden = next_hidden_noise(hidden)) {
    Attempt tried = attempt(with_noise(found.problem, hidden, options), points, options, stages);
    const PlacesOnWalls walls = walls_of(tried, noise);
    const double after = misfit(walls);
    // Half of the points of merged walls turn.
    const bool separates =
        hides || turned_share(first, walls) >= kDoubtful / 2 || tried.oriented.doubt <= kClearlyLess * found.oriented.doubt;
    if (!separates || after >= before || tried.stats.open_share > 0) return found;
    hides = tried.oriented.about_walls.is_two_walls();
    separated = std::move(tried);
    before = after;
  }
  if (!separated) return found;
  separated->solved.noise = found.solved.noise;
  separated->stats.noise = found.stats.noise;
  return std::move(*separated);
}

}  // namespace g3r
