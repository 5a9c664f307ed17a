// The whole program on one page: one line per step.
#include "cloud/canonical_cloud.h"
#include "cloud/noise.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/coarse_to_fine.h"
#include "orient/refine.h"
#include "orient/settings.h"
#include "solve/dense_solver.h"
#include "stages.h"
#include "sum/fast_sum.h"

#include <g3r/g3r.h>

#include <cmath>
#include <numeric>

namespace g3r {
namespace {

constexpr float kUnsure = 0.5F;      // confidence below which a point counts as unsure
constexpr double kManyUnsure = 0.2;  // share of unsure points above which the orientation is called inconsistent

// Options and cloud, resolved.
struct Problem {
  CanonicalCloud cloud;
  double spacing = 0;
  double noise = 0;
  Settings settings;
};

Problem prepare(const PointsView& points, const Options& options, Stages& stages) {
  Problem problem;
  stages.begin("build");
  problem.cloud = canonical_cloud(points);
  stages.check();
  problem.spacing = typical_spacing(local_spacing(problem.cloud.points));
  problem.noise = options.preset == Preset::kPaper ? 0 : estimate_noise(problem.cloud.points, problem.spacing);
  problem.settings = choose_settings(options, problem.cloud, problem.spacing, problem.noise);
  return problem;
}

void describe(const Problem& problem, const PointsView& points, const Options& options, Stats& stats) {
  const CanonicalCloud& cloud = problem.cloud;
  const Settings& settings = problem.settings;
  stats.points = points.count;
  stats.used = cloud.size();
  stats.dropped_non_finite = cloud.non_finite;
  stats.merged_duplicates = points.count - cloud.non_finite - cloud.size();
  stats.box_centre = cloud.frame.centre;
  stats.box_side = 2.0 / 1.1 / cloud.frame.scale;
  stats.spacing = cloud.frame.length_to_world(problem.spacing);
  stats.noise = cloud.frame.length_to_world(problem.noise);
  stats.epsilon = cloud.frame.length_to_world(settings.epsilon);
  stats.preset = options.preset == Preset::kPaper ? "paper" : "default";
  stats.method = settings.method == Method::kGreen ? "green" : "energy";
  stats.solver = settings.dense ? "dense" : "cg";
  stats.harmonics = settings.method == Method::kGreen ? format_harmonics(settings.harmonics) : "1,x,y,z";
  stats.sums = settings.dense || settings.sums.direct ? "direct" : "hierarchical";
  stats.accuracy = settings.sums.direct ? 0 : options.accuracy;
  stats.tolerance = settings.tolerance;
  stats.threads = parallel::thread_count(options.threads);
  stats.planned_memory_bytes = planned_memory(settings, points.count, cloud.size());
  if (stats.dropped_non_finite > 0) {
    stats.warnings.push_back(std::to_string(stats.dropped_non_finite) + " points with a non-finite coordinate were left out");
  }
  if (is_flat(cloud)) stats.warnings.emplace_back("the cloud is flat (all points in one plane): which side is outside is a choice");
}

// Beyond this the points fill a volume as much as they sample a surface.
void warn_of_noise(const Problem& problem, Stats& stats) {
  constexpr double kStrongNoise = 1.5;  // spacings
  if (problem.noise <= kStrongNoise * problem.spacing) return;
  stats.consistent = false;
  stats.warnings.emplace_back("very noisy: the points scatter by more than 1.5 spacings; detail below that is lost, or there is no surface");
}

void require_memory(const Stats& stats, const Options& options) {
  if (options.max_memory == 0 || stats.planned_memory_bytes <= options.max_memory) return;
  throw Unavailable("the plan needs " + std::to_string(stats.planned_memory_bytes >> 20) + " MiB, the limit is " +
                    std::to_string(options.max_memory >> 20) + " MiB; raise the limit or thin the cloud");
}

std::vector<Vec3> solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  if (s.dense) {
    DenseResult dense = solve_dense(problem.cloud.points, s.epsilon, s.harmonics, options.condition_number, stages.cancel());
    stats.converged = true;
    stats.condition_number = dense.condition_number;
    return std::move(dense.eta);
  }
  stages.begin("solve");
  IterativeResult result = solve_coarse_to_fine(problem.cloud.points, problem.cloud.morton, s, stages);
  stats.converged =
      result.converged || s.tolerance == 0 || (!result.residuals.empty() && result.residuals.back() <= s.accepted_residual);
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    stats.iterations.push_back({result.kinds[i] == StepKind::kSteepestDescent ? "sd" : "cg", result.residuals[i]});
  }
  return std::move(result.eta);
}

// From the canonical order back to the caller's. A duplicate gets its twin's normal and its share of the area.
void hand_out(const CanonicalCloud& cloud, const std::vector<Vec3>& eta, const std::vector<Vec3>& normals,
              const std::vector<float>& confidence, Orientation& out) {
  const std::size_t n = cloud.point_of.size();
  const double area_scale = 1 / (cloud.frame.scale * cloud.frame.scale);
  out.normals.assign(n, Vec3{0, 0, 0});
  out.areas.assign(n, 0);
  out.confidence.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t p = cloud.point_of[i];
    if (p == kNoPoint) continue;
    out.normals[i] = normals[p];
    out.areas[i] = area_scale * std::hypot(eta[p][0], eta[p][1], eta[p][2]) / cloud.multiplicity[p];
    out.confidence[i] = confidence[p];
  }
}

void judge(const CanonicalCloud& cloud, const std::vector<float>& confidence, Stats& stats) {
  double sum = 0;
  std::size_t unsure = 0;
  for (const float c : confidence) {
    sum += static_cast<double>(c);
    if (c < kUnsure) ++unsure;
  }
  const auto size = static_cast<double>(cloud.size());
  stats.confidence_mean = sum / size;
  stats.confidence_below_half = static_cast<double>(unsure) / size;
  if (!stats.converged) stats.warnings.emplace_back("the solver did not reach its tolerance; normals may be less accurate");
  stats.consistent = stats.confidence_below_half <= kManyUnsure;
  if (!stats.consistent) {
    stats.warnings.push_back("orientation not consistent: " + std::to_string(std::lround(100 * stats.confidence_below_half)) +
                             " % of the points could face either way; the cloud may be open, very noisy or too sparse");
  }
}

Orientation orient_in_arena(const PointsView& points, const Options& options, Stages& stages) {
  Orientation out;
  const Problem problem = prepare(points, options, stages);
  describe(problem, points, options, out.stats);
  require_memory(out.stats, options);
  const std::vector<Vec3> eta = solve(problem, options, stages, out.stats);
  stages.begin("refine");
  std::vector<Vec3> normals = normalised(eta);
  std::vector<double> strength;
  if (problem.settings.refinement_width > 0) {
    FastSum sum(problem.cloud.points, problem.cloud.morton, Widths(problem.settings.refinement_width), problem.settings.sums,
                stages.cancel());
    Refinement refined = refine_normals(sum, eta);
    normals = std::move(refined.normals);
    strength = std::move(refined.strength);
  }
  const std::vector<float> confidence = side_confidence(eta, normals, strength);
  judge(problem.cloud, confidence, out.stats);
  warn_of_noise(problem, out.stats);
  hand_out(problem.cloud, eta, normals, confidence, out);
  stages.finish(out.stats);
  return out;
}

}  // namespace

Orientation orient(const PointsView& points, const Options& options, const Monitor& monitor) {
  Stages stages(monitor);
  return parallel::with_threads(options.threads, [&] { return orient_in_arena(points, options, stages); });
}

Stats plan(const PointsView& points, const Options& options) {
  const Monitor monitor;
  Stages stages(monitor);
  return parallel::with_threads(options.threads, [&] {
    Stats stats;
    describe(prepare(points, options, stages), points, options, stats);
    stages.finish(stats);
    return stats;
  });
}

std::string_view version() { return "0.1.0"; }

}  // namespace g3r
