#include "orient/problem.h"

#include "cloud/far_points.h"
#include "cloud/noise.h"
#include "cloud/outliers.h"
#include "cloud/spacing.h"
#include "cloud/surface_distance.h"
#include "cloud/viewpoint.h"
#include "orient/crowded.h"
#include "orient/hints.h"
#include "orient/sensor_trust.h"
#include "orient/sight_normals.h"
#include "solve/part_system.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace g3r {
namespace {

void choose_scales(Problem& problem, const Options& options) {
  problem.settings = choose_settings(options, problem.cloud, problem.spacing, problem.noise, problem.outlier_share);
}

void choose_scales_and_scatter(Problem& problem, const Options& options) {
  choose_scales(problem, options);
  const bool fits_planes = runs(problem, Step::kPolish) && runs(problem, Step::kPlanes);
  if (fits_planes) problem.scatter = facet_scatter(problem.cloud.set);
}

// Of the points of a cloud, from the caller's order; outliers have none. Duplicates have merge(of those before, of the next), and the first
// of them merge(none, its own).
template <class T, class Merge>
std::vector<T> in_canonical_order(const CanonicalCloud& cloud, const std::vector<T>& values, const T& none, const Merge& merge) {
  std::vector<T> out(values.empty() ? 0 : cloud.size(), none);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (cloud.point_of[i] < out.size()) out[cloud.point_of[i]] = merge(out[cloud.point_of[i]], values[i]);
  }
  return out;
}

// Marks of the caller's points that are outliers.
std::vector<std::uint8_t> taken_out(const CanonicalCloud& cloud) {
  std::vector<std::uint8_t> marks(cloud.point_of.size());
  for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = cloud.point_of[i] >= cloud.size() && cloud.point_of[i] != kNoPoint ? 1 : 0;
  return marks;
}

// What tiles know of their points, which they hand over in an order of their own: of duplicates the last counts.
template <class T>
std::vector<T> last_in_canonical_order(const CanonicalCloud& cloud, const std::vector<T>& values) {
  return in_canonical_order(cloud, values, T{}, [](const T&, const T& next) { return next; });
}

// Whether no more is hidden from where the points have been seen than clutter hides. `views`: known.
bool hide_little(const PointSet& set, const Views& views, const std::atomic<bool>* cancel) {
  Hints hints;
  hints.sensors = views.places;
  hints.sensor_of_point = views.of_point;
  std::vector<std::uint32_t> all(set.size());
  std::iota(all.begin(), all.end(), 0U);
  return find_sensor_trust(set, all, hints, cancel).hidden_share <= kManyHidden;
}

// Where the caller says that the points have been seen from, if it says so of each and nothing hides anything; or the place that they show.
Views find_views(const CanonicalCloud& cloud, const Hints& hints, const std::atomic<bool>* cancel) {
  Views views;
  for (const Vec3& sensor : hints.sensors) views.places.push_back(cloud.frame.to_unit(sensor));
  views.of_point = sensors_of_points(cloud, hints.sensor_of_point);
  const bool named = views.places.size() == 1 || !views.of_point.empty();
  const bool each = std::count(views.of_point.begin(), views.of_point.end(), kNoSensor) == 0;
  if (views.places.size() == 1) views.of_point.clear();
  if (named && each && may_be_seen(cloud.points(), views) && hide_little(cloud.set, views, cancel)) return views;
  const std::optional<Vec3> shown = find_viewpoint(cloud.set, cloud.frame.to_unit({0, 0, 0}));
  return shown ? Views{{*shown}, {}} : Views{};
}

// The noise that options give, or 0 where none is to be looked for; else nothing.
std::optional<double> known_noise(const Options& options, const StepSet& without, const CanonicalCloud& cloud, double spacing) {
  const std::optional<double> given = given_noise(options.noise, cloud, spacing);
  return given || !contains(without, Step::kNoise) ? given : 0;
}

// Makes the cloud of the problem: without far points, and without outliers, which are looked for again in a frame of the others where these
// fill little of it, as far ones may have hidden nearer ones. Returns the noise of what is left, where the search for outliers has found
// it.
std::optional<double> make_cloud(const PointsView& points, const std::vector<double>& relative_spacing, const Options& options,
                                 const StepSet& without, Stages& stages, Problem& problem) {
  bool outliers_wanted = !contains(without, Step::kOutliers);
  std::vector<std::uint8_t> left_out;  // of the caller's points, for the frame to resolve the others
  if (outliers_wanted) left_out = far_points(points);
  problem.far = static_cast<std::size_t>(std::count(left_out.begin(), left_out.end(), 1));
  problem.cloud = canonical_cloud(points, left_out, problem.outliers);
  stages.check();
  std::optional<double> noise;
  while (outliers_wanted) {
    const PointSet& set = problem.cloud.set;
    Outliers found = find_outliers(set, last_in_canonical_order(problem.cloud, relative_spacing),
                                   known_noise(options, without, problem.cloud, set.spacing()));
    noise = found.noise;
    stages.check();
    if (found.indices.empty()) break;
    std::vector<Vec3> removed = remove_points(problem.cloud, found.indices, found.others);
    problem.outliers.insert(problem.outliers.begin(), removed.begin(), removed.end());
    outliers_wanted = is_small_in_frame(problem.cloud);
    if (!outliers_wanted) break;
    left_out = taken_out(problem.cloud);
    problem.cloud = canonical_cloud(points, left_out, problem.outliers);
  }
  require_not_collinear(problem.cloud.points(), problem.outliers.size());
  const auto all = static_cast<double>(problem.cloud.size() + problem.outliers.size());
  problem.outlier_share = static_cast<double>(problem.outliers.size()) / all;
  return noise;
}

// Known, brought to the points of the cloud.
Known known_of_points(const CanonicalCloud& cloud, Known given) {
  const auto any = [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); };
  return {last_in_canonical_order(cloud, std::exchange(given.gradient, {})),
          last_in_canonical_order(cloud, std::exchange(given.relative_spacing, {})),
          in_canonical_order(cloud, std::exchange(given.wanted, {}), std::uint8_t{0}, any),
          last_in_canonical_order(cloud, std::exchange(given.open, {}))};
}

// `found`: what make_cloud() has found.
void choose_noise(const std::optional<double>& given, const std::optional<double>& found, const std::atomic<bool>* cancel,
                  Problem& problem) {
  const PointSet& set = problem.cloud.set;
  const bool is_seen = set.views().known();
  if (is_seen) {
    const SightNoise along = given ? SightNoise{*given} : find_sight_noise(set, cancel);
    problem.direction_noise = given || along.deviation > 0 ? along.deviation : largest_scatter(set);
    problem.noise_together = along.together;
  }
  problem.noise = given ? *given : found ? *found : estimate_noise(set);
  if (problem.noise == 0 && !given && !is_seen) problem.direction_noise = fine_noise(set);
}

void choose_baseline_settings(const Options& options, Problem& problem) {
  if (!options.wnnc_widths.empty() && options.method != Method::kWnnc) throw InvalidInput("wnnc_widths belong to the method wnnc");
  if (!is_baseline(options.method)) return;
  const double epsilon = options.epsilon.unit == Length::Unit::kAuto ? 0 : problem.settings.epsilon.typical();
  problem.baseline = choose_baseline(options, epsilon, problem.spacing, problem.settings.sums);
}

}  // namespace

std::vector<std::uint32_t> sensors_of_points(const CanonicalCloud& cloud, const std::vector<std::uint32_t>& sensor_of_point) {
  return in_canonical_order(cloud, sensor_of_point, kNoSensor, [](std::uint32_t a, std::uint32_t b) { return std::min(a, b); });
}

std::vector<double> relative_spacing(const Problem& problem, const Options& options) {
  const bool is_free = problem.settings.method == Method::kEnergy && options.epsilon.unit == Length::Unit::kAuto;
  const std::vector<double>& thinned = problem.known.relative_spacing;
  if (!is_free || !runs(problem, Step::kLocalWidths)) return thinned;
  std::vector<double> relative = spacing_before_thinning(problem.cloud.set.smoothed_spacing(), thinned);
  // Up to one standard deviation above the typical spacing noise alone may have scattered points: kernels keep one width there. The area of
  // n random points is off by 1 / sqrt(n), a side by half of that.
  const double chance = 1 / (2 * std::sqrt(static_cast<double>(kSpacingNeighbours)));
  const double typical = (problem.is_clean() ? 1 : 1 + chance) * problem.spacing;
  for (double& h : relative) h = std::max(h / typical, narrowing(h / typical));
  for (std::size_t i = 0; i < thinned.size(); ++i) relative[i] *= thinned[i];
  return relative;
}

Problem prepare(const PointsView& points, Known known, const Options& options, Stages& stages) {
  require_sound(options.hints, points.count);
  Problem problem;
  stages.begin("build");
  const StepSet without = steps_left_out(options);
  const std::optional<double> found_noise = make_cloud(points, known.relative_spacing, options, without, stages, problem);
  if (known.gradient.empty() && !contains(without, Step::kViewpoint)) {
    problem.cloud.set.set_views(find_views(problem.cloud, options.hints, stages.cancel()));
    stages.check();
  }
  const PointSet& set = problem.cloud.set;
  problem.known = known_of_points(problem.cloud, std::move(known));
  problem.spacing = typical_spacing(spacing_before_thinning(set.local_spacing(), problem.known.relative_spacing));
  stages.check();
  choose_noise(known_noise(options, without, problem.cloud, problem.spacing), found_noise, stages.cancel(), problem);
  stages.check();
  if (!contains(without, Step::kSites)) problem.line_distance = surface_distances(set, stages.cancel());
  stages.check();
  choose_scales_and_scatter(problem, options);
  stages.check();
  choose_baseline_settings(options, problem);
  return problem;
}

Problem with_noise(const Problem& problem, double noise, const Options& options) {
  Problem same = problem;
  same.noise = noise;
  choose_scales(same, options);
  return same;
}

Problem on_sites(const Problem& problem, const Sites& sites, const Options& options) {
  Problem coarse;
  coarse.cloud.frame = problem.cloud.frame;
  coarse.cloud.set = sites.set;
  coarse.spacing = sites.set.spacing();
  coarse.outlier_share = problem.outlier_share;
  const std::optional<double> given = given_noise(options.noise, problem.cloud, problem.spacing);
  coarse.noise = given ? *given : !runs(problem, Step::kNoise) ? 0 : estimate_noise(sites.set);
  choose_scales_and_scatter(coarse, options);
  return coarse;
}

Problem part_of(const Problem& problem, const std::vector<std::uint32_t>& some, const Options& options) {
  Problem part;
  part.cloud.frame = problem.cloud.frame;
  std::vector<Vec3> points;
  for (const std::uint32_t i : some) {
    points.push_back(problem.cloud.points()[i]);
    if (!problem.known.gradient.empty()) part.known.gradient.push_back(problem.known.gradient[i]);
    if (!problem.known.relative_spacing.empty()) part.known.relative_spacing.push_back(problem.known.relative_spacing[i]);
    if (!problem.known.wanted.empty()) part.known.wanted.push_back(problem.known.wanted[i]);
    if (!problem.known.open.empty()) part.known.open.push_back(problem.known.open[i]);
  }
  Views views = problem.cloud.set.views();
  if (!views.of_point.empty()) views.of_point = values_at(some, views.of_point);
  part.cloud.set = PointSet(std::move(points), std::move(views));
  part.spacing = typical_spacing(spacing_before_thinning(part.cloud.set.local_spacing(), part.known.relative_spacing));
  part.noise = problem.noise;
  part.direction_noise = problem.direction_noise;
  part.noise_together = problem.noise_together;
  part.outlier_share = problem.outlier_share;
  Options same = options;
  if (options.epsilon.unit == Length::Unit::kPercent) {  // of the whole cloud's box
    same.epsilon = {Length::Unit::kInput, problem.cloud.frame.length_to_world(problem.settings.epsilon.typical())};
  }
  choose_scales_and_scatter(part, same);
  return part;
}

}  // namespace g3r
