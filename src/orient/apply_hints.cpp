#include "orient/apply_hints.h"

#include "base/number_text.h"
#include "base/vector.h"
#include "orient/assess.h"
#include "orient/confidence.h"
#include "orient/describe.h"
#include "orient/hints.h"
#include "orient/open_to_views.h"
#include "orient/over_others.h"
#include "orient/sensor_trust.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace g3r {
namespace {

std::string in_words(const Vec3& place) {
  return short_number(place[0], 7) + ',' + short_number(place[1], 7) + ',' + short_number(place[2], 7);
}

double share(const std::vector<std::uint8_t>& marked) {
  const auto count = static_cast<double>(std::count_if(marked.begin(), marked.end(), [](std::uint8_t m) { return m != 0; }));
  return marked.empty() ? 0 : count / static_cast<double>(marked.size());
}

// In the problem's frame and order. Points at one place take the first of their sensors.
Hints in_frame(const Hints& given, const CanonicalCloud& cloud) {
  Hints hints = given;
  for (Vec3& place : hints.sensors) place = cloud.frame.to_unit(place);
  for (Vec3& place : hints.inside) place = cloud.frame.to_unit(place);
  if (given.sensor_of_point.empty()) return hints;
  hints.sensor_of_point = sensors_of_points(cloud, given.sensor_of_point);
  return hints;
}

Patches patches_of(const OpenSurfaces& surfaces) {
  Patches patches;
  patches.of = surfaces.part;
  patches.certainty = surfaces.certainty;
  patches.agreed = surfaces.certified;
  patches.held = surfaces.held;
  return patches;
}

// What sensors vote on.
std::vector<std::uint32_t> open_points(std::size_t count, const Patches& patches) {
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!patches.is_closed(i)) open.push_back(i);
  }
  return open;
}

// Of what hints decide: over_others().
std::vector<std::uint8_t> open_over_others(const Problem& problem, const Patches& patches, const std::vector<Vec3>& normals, const Vec3& up,
                                           const std::atomic<bool>* cancel) {
  std::vector<std::uint8_t> over = over_others(problem.cloud.points(), normals, up, problem.noise, cancel);
  for (std::size_t i = 0; i < over.size(); ++i) {
    if (patches.is_closed(i) || patches.certainty[i] >= 1) over[i] = 0;
  }
  return over;
}

// Whether hints say of any side that it is seen, or is outside.
bool have_votes(const Hints& hints) { return hints.up || !hints.sensors.empty() || !hints.inside.empty() || hints.seen_from_inside; }

bool is_up_alone(const Hints& hints) { return hints.up && hints.sensors.empty() && hints.inside.empty() && !hints.seen_from_inside; }

// Shares, with what views have decided before any vote: sides that they turned, or all, where these come from the lines of sight alone.
void count_sides(const HintEffect& effect, const Problem& problem, const Solution& solution, bool flip, HintStats& hints) {
  std::vector<std::uint8_t> turned = effect.turned, decided = effect.decided;
  turned.resize(problem.cloud.size(), 0);
  decided.resize(problem.cloud.size(), 0);
  if (is_seen_in_noise(problem)) std::fill(decided.begin(), decided.end(), std::uint8_t{1});
  for (std::size_t i = 0; i < solution.turned_to_views.size(); ++i) {
    turned[i] ^= solution.turned_to_views[i];
    decided[i] |= solution.turned_to_views[i];
  }
  hints.turned_share = flip ? 1 - share(turned) : share(turned);
  hints.settled_share = share(decided);
}

// `given`: in the coordinates of the caller; `over_share`: of the points, those that lie over others.
void warn(const HintEffect& effect, const Hints& given, bool any_open, double over_share, Stats& stats) {
  const std::string against = percent(effect.contradicted_share);
  if (effect.contradicted_share > 0 && effect.closed_parts_turned) {
    stats.warnings.push_back("hint sensor: the scanner stood inside the closed parts, and " + against +
                             " of their votes said that they faced away from it: they have been turned to face it");
  } else if (effect.contradicted_share > 0) {
    stats.warnings.push_back("hint sensor: it contradicts the closed parts, " + against +
                             " of whose votes say that they face away from the scanner; they keep their sides");
  }
  if (effect.inside_that_is_outside) {
    stats.warnings.push_back("hint inside: " + in_words(given.inside[*effect.inside_that_is_outside]) +
                             " is not inside the closed parts; they keep their sides");
  }
  if (stats.hints.hidden_share > kManyHidden) {
    stats.warnings.push_back("hint sensor: " + percent(stats.hints.hidden_share) +
                             " of the points of open surfaces cannot be seen from there, as other points lie in front of them, so that "
                             "it decides little: check where the scanner stood, and give all its places");
  }
  if (over_share > kManyHidden) {
    stats.warnings.push_back("hint up: " + percent(over_share) +
                             " of the points lie over others, so that they may have been seen from below: their side is right with a "
                             "chance of two thirds; --sensor decides it");
  }
  if (given.up && !any_open) stats.warnings.emplace_back("hint up: it decides nothing, as no part of the cloud is open");
}

// Of open parts that bend the side that encloses less was taken, of others the one that faces up.
void warn_of_choices(const CanonicalCloud& cloud, const OpenSurfaces& surfaces, const Hints& given, Stats& stats) {
  if (stats.undecided_share == 0) {
    if (stats.open_share == 0) warn_of_flat(cloud, stats);  // nobody has looked for open surfaces
    return;
  }
  std::string side;
  if (have_votes(given)) {
    side = given.flip ? "the other hints left as it was and --flip turned" : "the hints left as it was";
  } else {
    bool any_bends = false;
    for (std::size_t i = 0; i < surfaces.part.size() && !any_bends; ++i) {
      any_bends = surfaces.is_choice(i) && surfaces.certainty[i] > kUndecided;
    }
    if (any_bends) side = given.flip ? "bends inward where one does, else " : "bends outward where one does, else ";
    side += given.flip ? "faces down (-z), turned by --flip" : "faces up (+z)";
    side += "; a hint decides it (--up, --sensor, --seen-from-inside)";
  }
  stats.warnings.push_back("which side of " + percent(stats.undecided_share) + " of the points" +
                           (is_flat(cloud) ? ", all in one plane," : "") + " is the outside is a choice: the one that " + side);
}

}  // namespace

void apply_hints(const Problem& problem, const Options& options, Solution& solution, std::vector<float>& confidence, Stats& stats,
                 const std::atomic<bool>* cancel) {
  const Hints& given = options.hints;
  Hints hints = in_frame(given, problem.cloud);
  stats.hints.given = names_of(given);
  const Views& views = problem.cloud.set.views();
  if (views.is_one()) {
    stats.hints.viewpoint = problem.cloud.frame.to_world(views.places.front());
    const bool says_otherwise = hints.up || !hints.inside.empty();
    if (hints.sensors.empty() && (hints.seen_from_inside || !says_otherwise)) hints.sensors = views.places;
  }
  Patches patches = patches_of(solution.open_surfaces);
  patches.seen = views.known() && hints.sensors == views.places;
  HintEffect effect;
  SensorTrust trust;
  std::vector<std::uint8_t> over;
  if (have_votes(hints) || hints.flip) {
    const SidedPoints sided{solution.refinement.normals, solution.eta, confidence};
    if (!patches.seen) trust = find_sensor_trust(problem.cloud.set, open_points(problem.cloud.size(), patches), hints, cancel);
    if (is_up_alone(hints)) over = open_over_others(problem, patches, sided.normals, vector::normalised(*hints.up), cancel);
    effect = follow_hints({problem.cloud.points(), problem.cloud.set.near(), problem.spacing, patches, hints, sided, trust.of_sensor, over},
                          cancel);
  }
  count_sides(effect, problem, solution, hints.flip, stats.hints);
  stats.hints.agreement = effect.agreement;
  stats.hints.contradicted_share = effect.contradicted_share;
  stats.hints.hidden_share = trust.hidden_share;
  summarise_sides(solution.open_surfaces, confidence, effect.decided, stats);
  if (effect.contradicted_share > kUndecided && !effect.closed_parts_turned) stats.consistent = false;
  if (trust.hidden_share > kManyHidden) stats.consistent = false;
  warn_of_unsure(solution.open_surfaces, confidence, stats);
  warn(effect, given, stats.open_share > 0, share(over), stats);
  warn_of_choices(problem.cloud, solution.open_surfaces, given, stats);
}

}  // namespace g3r
