#include "orient/describe.h"

#include "base/bisect.h"
#include "base/number_text.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/noise.h"
#include "cloud/sites.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/confidence.h"
#include "orient/memory_plan.h"

#include <g3r/names.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace g3r {
namespace {

// Dimension from which points fill a volume, midway between those of surfaces and of volumes: of 800 points and more cubes and balls have
// 2.63 and more, spheres and tori under noise of 2 h at most 2.39 of 5000, but 2.7 of 1600, about whose surface such noise fills the space.
constexpr double kVolume = (2 + 3) / 2.0;

// The noise that directions by known lines of sight follow; exact places leave rounding of it.
double noise_of_sight(const Problem& problem) {
  const bool is_noise = problem.cloud.set.views().known() && problem.direction_noise > kExactScatter * problem.spacing;
  return is_noise ? problem.direction_noise : 0;
}

void describe_baseline(const Problem& problem, Stats& stats) {
  stats.epsilon = problem.cloud.frame.length_to_world(problem.baseline->epsilon);
  stats.solver = problem.settings.method == Method::kWnnc ? "wnnc" : "cg";
  stats.harmonics = std::string(1, '1');
  stats.tolerance = problem.baseline->tolerance;
  stats.planned_memory_bytes += baseline_memory(*problem.baseline, problem.spacing, problem.cloud.size());
}

// The highest that the field of a body within a box of these sides may be, seen through kernels of this width: that of all of the box, at
// its middle.
double highest_field(const Vec3& sides, double width) {
  double field = 1;
  for (const double side : sides) field *= std::erf(side / (2 * std::numbers::sqrt2 * width));
  return field;
}

// A given epsilon so wide that nothing in the box of the points can have a field that says inside, where the spacing asks for one that can.
void warn_of_width(const Problem& problem, const Options& options, Stats& stats) {
  if (options.epsilon.unit == Length::Unit::kAuto || problem.baseline) return;
  vector::Box box;
  for (const Vec3& p : problem.cloud.points()) box.extend(p);
  const Vec3 sides = vector::subtract(box.high, box.low);
  const double width = problem.settings.epsilon.typical();
  constexpr double kOnSurface = 0.5;
  const auto shows = [&](double w) { return highest_field(sides, w) > kOnSurface; };
  if (shows(width) || !shows(kEpsilon * problem.spacing)) return;
  const auto length = [&](double x) { return short_number(problem.cloud.frame.length_to_world(x), 2); };
  const double most = last_that(shows);
  stats.doubtful = true;
  stats.warnings.push_back("epsilon is " + length(width) + ", too wide for a cloud of " + length(sides[0]) + " x " + length(sides[1]) +
                           " x " + length(sides[2]) + ": within what these points enclose the field is " +
                           short_number(highest_field(sides, width), 2) +
                           " at most, and only above 0.5 is inside; leave epsilon out, or give less than " + length(most) + " (" +
                           short_number(most / problem.spacing, 2) + " spacings)");
}

// No points are farther from their surface than the cloud is wide.
void warn_of_noise(const Options& options, Stats& stats) {
  if (options.noise.unit == Length::Unit::kAuto || stats.noise <= stats.box_side) return;
  stats.doubtful = true;
  stats.warnings.push_back("noise is " + short_number(stats.noise, 2) + ", more than all of the cloud is wide, " +
                           short_number(stats.box_side, 2) +
                           ": leave noise out, or give the standard deviation of the points from their surface");
}

void warn_of_points(const Problem& problem, Stats& stats) {
  if (stats.dropped_non_finite > 0) {
    stats.warnings.push_back(std::to_string(stats.dropped_non_finite) + " points with a non-finite coordinate were left out");
  }
  warn_of_far(problem.far, stats);
  if (problem.spacing <= kLeastSpacing) {
    stats.warnings.emplace_back(
        "the points are closer together than a millionth of the cloud's width, too close for the solver: "
        "treat parts that are far apart one by one");
  }
}

}  // namespace

void describe(const Problem& problem, const PointsView& points, const Options& options, Stats& stats) {
  const CanonicalCloud& cloud = problem.cloud;
  const Settings& settings = problem.settings;
  stats.points = points.count;
  stats.used = cloud.size();
  stats.dropped_non_finite = cloud.non_finite;
  stats.outliers = problem.outliers.size();
  stats.merged_duplicates = points.count - cloud.non_finite - cloud.size() - problem.outliers.size();
  stats.box_centre = cloud.frame.centre;
  stats.box_side = kBoxSide / cloud.frame.scale;
  stats.spacing = cloud.frame.length_to_world(problem.spacing);
  const bool is_coarse = starts_coarse(settings, cloud.size());
  stats.noise = cloud.frame.length_to_world(std::max(problem.noise, noise_of_sight(problem)));
  stats.epsilon = cloud.frame.length_to_world((is_coarse ? settings.epsilon : settings.coarsest_epsilon).typical());
  stats.preset = name_of(options.preset);
  stats.method = name_of(settings.method);
  stats.solver = name_of(settings.dense ? Solver::kDense : Solver::kConjugateGradient);
  stats.harmonics = settings.method == Method::kGreen ? format_harmonics(settings.harmonics) : "1,x,y,z";
  stats.sums = settings.dense || settings.sums.direct ? "direct" : "hierarchical";
  stats.accuracy = settings.sums.direct ? 0 : settings.accuracy;
  stats.tolerance = is_coarse ? settings.continued_tolerance : settings.tolerance;
  stats.threads = parallel::thread_count(options.threads);
  stats.planned_memory_bytes = planned_memory(settings, points.count, cloud.size());
  if (problem.baseline) describe_baseline(problem, stats);
  warn_of_points(problem, stats);
  warn_of_width(problem, options, stats);
  warn_of_noise(options, stats);
}

void warn_of_far(std::size_t far, Stats& stats) {
  if (far <= kSmallPart) return;
  stats.doubtful = true;
  stats.warnings.push_back(std::to_string(far) +
                           " points are too far from the others for one solve to resolve both, and were left out: check their coordinates, "
                           "or treat them on their own");
}

void warn_of_flat(const CanonicalCloud& cloud, Stats& stats) {
  if (!is_flat(cloud)) return;
  stats.warnings.emplace_back("the cloud is flat (all points in one plane): nothing but a hint says which side is outside");
}

void warn_of_volume(const Problem& problem, Stats& stats) {
  if (problem.settings.cluster_side == 0) return;
  if (dimension(problem.cloud.set) < kVolume) return;
  stats.consistent = false;
  stats.warnings.emplace_back("the points fill a volume: there is no surface, or the noise hides it");
}

void warn_of_few_points(const std::vector<float>& confidence, Stats& stats) {
  const auto shows = [](float c) { return c > kUndecided; };
  if (!stats.consistent || confidence.size() >= kFewestSites || std::any_of(confidence.begin(), confidence.end(), shows)) return;
  stats.consistent = false;
  stats.warnings.push_back(std::to_string(confidence.size()) +
                           " points are too few to show which side is outside: none is surer than a guess");
}

}  // namespace g3r
