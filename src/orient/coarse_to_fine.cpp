#include "orient/coarse_to_fine.h"

#include "base/vector.h"
#include "cloud/chance.h"
#include "orient/confidence.h"
#include "orient/open_surfaces.h"
#include "orient/polish.h"
#include "orient/unsure.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "solve/part_system.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace g3r {
namespace {

// The share of the progress bar that the coarser levels of a level take: a quarter of the points, beside all.
const double kCoarseShare = 1.0 / (1 + kTwiceAsFar);

Settings coarser(Settings settings) {
  settings.spacing *= kLevelRatio;
  for (KernelWidth* width : {&settings.epsilon, &settings.coarsest_epsilon, &settings.refinement_width}) {
    width->points *= kLevelRatio;
    width->noise *= kLevelRatio;
  }
  settings.winding_weight *= kLevelRatio * kLevelRatio * kLevelRatio;  // a volume
  settings.tolerance = settings.start_tolerance;
  settings.first_sums = settings.sums;
  return settings;
}

template <class T>
std::vector<T> every(std::size_t step, const std::vector<T>& values) {
  std::vector<T> some;
  for (std::size_t i = step / 2; i < values.size(); i += step) some.push_back(values[i]);
  return some;
}

// The points of a level, and how many times as far apart each is as the others, less than 1 where they crowd; empty: all are equally far
// apart.
struct LevelCloud {
  const std::vector<Vec3>& points;
  const std::vector<double>& relative_spacing;
};

// A quarter of the points, and as much of the area that those stand for which crowd.
std::vector<Vec3> quarter_of(const LevelCloud& cloud) {
  std::vector<Vec3> some;
  double next = static_cast<double>(kTwiceAsFar) / 2;
  double end = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double relative = cloud.relative_spacing.empty() ? 1 : std::min(1.0, cloud.relative_spacing[i]);
    end += relative * relative;
    if (end <= next) continue;
    some.push_back(cloud.points[i]);
    next += static_cast<double>(kTwiceAsFar);
  }
  return some;
}

std::vector<double> spacing_of(const LevelCloud& cloud, const Settings& settings) {
  return scaled(settings.spacing, cloud.relative_spacing);
}

// A sum of kernels of this width.
FastSum sum_over(const LevelCloud& cloud, const Settings& settings, const KernelWidth& width, const SumPlan& plan, const Stages& stages) {
  return {cloud.points, local_widths(width, settings, spacing_of(cloud, settings)), plan, stages.cancel()};
}

// A solution and the sum, of width settings.refinement_width, that evaluates its field.
struct Level {
  IterativeResult result;
  std::unique_ptr<FastSum> field;
};

Level solve_level(const LevelCloud& cloud, const Settings& settings, double share, Stages& stages, const std::vector<Vec3>& gradient);

// The winding gradient at the points of the solution on quarter_of() them, all with kernels of one width: a field of several has no value
// between its points.
std::vector<Vec3> coarse_gradient(const LevelCloud& cloud, const Settings& settings, double share, Stages& stages) {
  const std::vector<Vec3> points = quarter_of(cloud);
  const std::vector<double> one_width;
  const Level coarse = solve_level({points, one_width}, coarser(settings), kCoarseShare * share, stages, {});
  return coarse.field->winding_gradient_at(coarse.result.eta, cloud.points, stages.cancel());
}

std::vector<float> confidence_of(const LevelCloud& cloud, const Settings& settings, const std::vector<Vec3>& eta,
                                 const Refinement& refined) {
  return side_confidence(eta, refined.normals, refined.strength, point_areas(settings, spacing_of(cloud, settings)));
}

// Whether most of the points lie on surfaces without an inside, by the field of some of them.
bool is_mostly_open(const LevelCloud& cloud, const Settings& settings, const std::vector<Vec3>& normals, const Stages& stages) {
  const std::size_t step = std::max<std::size_t>(1, cloud.points.size() / kFewestCoarsePoints);
  const PointSet set(every(step, cloud.points));
  std::vector<Vec3> sides = every(step, normals);
  const OpenSurfaces surfaces = find_open_surfaces(set, settings.noise, settings.sums, sides, stages.cancel());
  const auto closed = std::count(surfaces.part.begin(), surfaces.part.end(), OpenSurfaces::kNone);
  const auto all = static_cast<double>(surfaces.part.size());
  return is_majority(all - static_cast<double>(closed), all);
}

// What a solve starts from, and how long it goes on.
struct Course {
  std::vector<Vec3> start;  // area vectors; empty: zeros
  std::vector<Steps> schedule;
  double tolerance = 0;                           // relative residual at which it ends earlier
  std::function<void(int, int, double)> observe;  // called after every step with its number, that of all, and the residual
};

// Area vectors by settings.method.
IterativeResult solve_for_areas(FastSum& sum, const LevelCloud& cloud, const Settings& settings, Course course) {
  if (settings.method == Method::kGreen) {
    GreenSystem system(sum, cloud.points, settings.harmonics);
    return solve_iteratively(system, course.schedule, course.tolerance, std::move(course.start), course.observe);
  }
  EnergySystem system(sum, 0, settings.winding_weight, cloud.relative_spacing);
  IterativeResult result =
      solve_iteratively(system, course.schedule, course.tolerance, system.from_areas(std::move(course.start)), course.observe);
  result.eta = system.to_areas(std::move(result.eta));
  return result;
}

// From eta = 0.
IterativeResult solve_from_zero(const LevelCloud& cloud, const Settings& settings, double share, Stages& stages) {
  FastSum sum = sum_over(cloud, settings, settings.coarsest_epsilon, settings.first_sums, stages);
  return solve_for_areas(sum, cloud, settings, {{}, settings.schedule, settings.tolerance, [&](int step, int steps, double) {
                                                  stages.progress(share * step / steps);
                                                }});
}

// From a winding gradient at the points.
IterativeResult solve_on(FastSum& field, const LevelCloud& cloud, const Settings& settings, double share, Stages& stages,
                         std::vector<Vec3> gradient) {
  std::vector<double> spacing = spacing_of(cloud, settings);
  const bool is_narrower =
      settings.epsilon.points <= settings.refinement_width.points && settings.epsilon.noise <= settings.refinement_width.noise;
  FastSum sum = is_narrower ? FastSum(field, local_widths(settings.epsilon, settings, spacing))
                            : sum_over(cloud, settings, settings.epsilon, settings.sums, stages);
  gradient_to_areas(sum, point_areas(settings, spacing), gradient);
  std::vector<double>().swap(spacing);
  return solve_for_areas(sum, cloud, settings,
                         {std::move(gradient), settings.continued_schedule, settings.continued_tolerance, [&](int step, int steps, double) {
                            stages.progress(share * (kCoarseShare + (1 - kCoarseShare) * step / steps));
                          }});
}

// More steps for the points around unsure sides, from what is known; the others are held.
IterativeResult solve_around_unsure(const LevelCloud& cloud, const Settings& settings, const std::vector<std::uint8_t>& unsure,
                                    Stages& stages, std::vector<Vec3> start) {
  const std::vector<double> spacing = cloud.relative_spacing.empty() ? std::vector<double>{settings.spacing} : spacing_of(cloud, settings);
  const std::vector<std::uint32_t> some = around_unsure(cloud.points, spacing, unsure);
  const auto with_system = [&](const LevelCloud& of, const auto& work) {
    FastSum sum = sum_over(of, settings, settings.coarsest_epsilon, settings.first_sums, stages);
    EnergySystem system(sum, 0, settings.winding_weight, of.relative_spacing);
    return work(system);
  };
  const PartResidual right = with_system(cloud, [&](EnergySystem& all) { return residual_at(some, all, all.from_areas(start)); });
  const std::vector<Vec3> points = values_at(some, cloud.points);
  const std::vector<double> relative = values_at(some, cloud.relative_spacing);
  IterativeResult result = with_system({points, relative}, [&](EnergySystem& part) {
    IterativeResult change = solve_for_part(part, right, settings.doubtful_schedule, settings.doubtful_tolerance,
                                            [&](int, int, double) { stages.still_going(); });
    change.eta = part.to_areas(std::move(change.eta));
    return change;
  });
  for (std::size_t k = 0; k < some.size(); ++k) start[some[k]] = vector::add(start[some[k]], result.eta[k]);
  result.eta = std::move(start);
  return result;
}

// More steps where the sides of many points are unsure, but for surfaces of which the equations are not true.
void solve_doubtful(FastSum& field, const LevelCloud& cloud, const Settings& settings, Stages& stages, IterativeResult& result) {
  const Refinement refined = refine_normals(field, result.eta);
  const std::vector<float> confidence = confidence_of(cloud, settings, result.eta, refined);
  const double unsure = unsure_share(confidence);
  if (unsure < kDoubtful + settings.unsure_of_noise) return;
  if (is_mostly_open(cloud, settings, refined.normals, stages)) return;
  IterativeResult more = solve_around_unsure(cloud, settings, unsure_points(confidence), stages, result.eta);
  if (settings.unsure_of_noise == 0) {
    const Refinement after = refine_normals(field, more.eta);
    if (unsure_share(confidence_of(cloud, settings, more.eta, after)) > unsure) return;
  }
  more.kinds.insert(more.kinds.begin(), result.kinds.begin(), result.kinds.end());
  more.residuals.insert(more.residuals.begin(), result.residuals.begin(), result.residuals.end());
  result = std::move(more);
}

// `share`: of all progress, where this level ends; the coarser ones take kCoarseShare of it. `gradient`: a winding gradient to start from,
// empty for that of the coarser ones.
Level solve_level(const LevelCloud& cloud, const Settings& settings, double share, Stages& stages, const std::vector<Vec3>& gradient) {
  Level level;
  const auto make_field = [&] {
    level.field = std::make_unique<FastSum>(sum_over(cloud, settings, settings.refinement_width, settings.sums, stages));
  };
  if (!starts_coarse(settings, cloud.points.size())) {
    level.result = solve_from_zero(cloud, settings, share, stages);
    if (settings.refinement_width.typical() > 0) make_field();
    return level;
  }
  make_field();
  level.result =
      solve_on(*level.field, cloud, settings, share, stages, gradient.empty() ? coarse_gradient(cloud, settings, share, stages) : gradient);
  if (!level.result.converged && !settings.doubtful_schedule.empty()) solve_doubtful(*level.field, cloud, settings, stages, level.result);
  return level;
}

}  // namespace

Solved solve_coarse_to_fine(const std::vector<Vec3>& points, const Settings& settings, Stages& stages,
                            const std::vector<double>& relative_spacing, const std::vector<Vec3>& gradient) {
  Level level = solve_level({points, relative_spacing}, settings, 1, stages, gradient);
  stages.begin("refine");
  if (settings.refinement_width.typical() == 0) return {std::move(level.result), {}};
  Refinement refinement = refine_normals(*level.field, level.result.eta);
  return {std::move(level.result), std::move(refinement)};
}

}  // namespace g3r
