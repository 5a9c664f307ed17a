// The whole program on one page: one line per step.
#include "baselines/baseline.h"
#include "cloud/canonical_cloud.h"
#include "cloud/clusters.h"
#include "cloud/neighbours.h"
#include "cloud/noise.h"
#include "cloud/outliers.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/coarse_to_fine.h"
#include "orient/creases.h"
#include "orient/jets.h"
#include "orient/open_sheets.h"
#include "orient/polish.h"
#include "orient/refine.h"
#include "orient/settings.h"
#include "solve/dense_solver.h"
#include "solve/energy_system.h"
#include "solve/green_system.h"
#include "solve/iterative_solver.h"
#include "stages.h"
#include "sum/fast_sum.h"

#include <g3r/g3r.h>

#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

namespace g3r {
namespace {

constexpr std::size_t kNear = 17;          // a point and its 16 nearest
constexpr std::size_t kFewestApart = 100;  // points that are solved for again without the open sheets of their cloud
constexpr std::uint32_t kFewer = 4;        // points for one of start_on_fewer()
constexpr int kStepsAfterFewer = 1;        // of the polish after it
constexpr double kFewUnsure = 0.04;        // share of unsure points up to which its result is taken
constexpr double kLessUnsure = 0.95;       // of that share, up to which a solve from zero is better
constexpr double kSameSide = 0.5;          // cosine between the normals of a point and of its cluster on an open sheet
constexpr double kManyUnsure = 0.2;        // share of unsure points above which the orientation is called inconsistent

// Options and cloud, resolved.
struct Problem {
  CanonicalCloud cloud;
  std::vector<Vec3> outliers;         // taken out of the cloud; their indices follow those of its points
  std::vector<std::uint32_t> near;    // kNear nearest of every point, itself included; with local_spacing only
  std::vector<double> local_spacing;  // smoothed, per point; of clean clouds only
  double spacing = 0;
  double noise = 0;
  Settings settings;
  std::optional<BaselineSettings> baseline;  // with the methods wnnc, agr and pgr
};

// What the steps after noise and outliers need. `near`: kNear nearest of every point; `local`: local_spacing().
void choose_scales(Problem& problem, const Options& options, std::vector<std::uint32_t> near, const std::vector<double>& local) {
  problem.settings = choose_settings(options, problem.cloud, problem.spacing, problem.noise, problem.outliers.size());
  if (problem.noise > 0 || problem.settings.polish_steps == 0) return;
  problem.local_spacing = smoothed_spacing(local, near);
  problem.near = std::move(near);
}

Problem prepare(const PointsView& points, const Options& options, Stages& stages) {
  Problem problem;
  stages.begin("build");
  problem.cloud = canonical_cloud(points);
  stages.check();
  const std::vector<Vec3>& cloud = problem.cloud.points;
  auto neighbours = std::make_unique<Neighbours>(cloud);
  std::vector<std::uint32_t> near = neighbours->of_all(kNear);
  std::vector<double> local = local_spacing(cloud, near);
  problem.spacing = typical_spacing(local);
  if (options.preset != Preset::kPaper && !is_baseline(options.method)) {
    const std::vector<std::uint32_t> outliers = find_outliers(cloud, near, local, problem.spacing);
    if (!outliers.empty()) {
      problem.outliers = remove_points(problem.cloud, outliers);
      neighbours = std::make_unique<Neighbours>(cloud);
      near = neighbours->of_all(kNear);
      local = local_spacing(cloud, near);
    }
  }
  problem.noise = options.preset == Preset::kPaper ? 0 : estimate_noise(cloud, *neighbours, problem.spacing);
  choose_scales(problem, options, std::move(near), local);
  if (!options.wnnc_widths.empty() && options.method != Method::kWnnc) throw InvalidInput("wnnc_widths belong to the method wnnc");
  if (is_baseline(options.method)) {
    const double epsilon = options.epsilon.unit == Epsilon::Unit::kAuto ? 0 : problem.settings.epsilon;
    problem.baseline = choose_baseline(options, epsilon, problem.spacing, problem.settings.sums);
  }
  return problem;
}

const char* name_of(Method method) {
  switch (method) {
    case Method::kGreen:
      return "green";
    case Method::kWnnc:
      return "wnnc";
    case Method::kAgr:
      return "agr";
    case Method::kPgr:
      return "pgr";
    default:
      return "energy";
  }
}

void describe(const Problem& problem, const PointsView& points, const Options& options, Stats& stats) {
  const CanonicalCloud& cloud = problem.cloud;
  const Settings& settings = problem.settings;
  stats.points = points.count;
  stats.used = cloud.size();
  stats.dropped_non_finite = cloud.non_finite;
  stats.outliers = problem.outliers.size();
  stats.merged_duplicates = points.count - cloud.non_finite - cloud.size() - problem.outliers.size();
  stats.box_centre = cloud.frame.centre;
  stats.box_side = 2.0 / 1.1 / cloud.frame.scale;
  stats.spacing = cloud.frame.length_to_world(problem.spacing);
  stats.noise = cloud.frame.length_to_world(problem.noise);
  stats.epsilon = cloud.frame.length_to_world(settings.epsilon);
  stats.preset = options.preset == Preset::kPaper ? "paper" : "default";
  stats.method = name_of(settings.method);
  stats.solver = settings.dense ? "dense" : "cg";
  stats.harmonics = settings.method == Method::kGreen ? format_harmonics(settings.harmonics) : "1,x,y,z";
  stats.sums = settings.dense || settings.sums.direct ? "direct" : "hierarchical";
  stats.accuracy = settings.sums.direct ? 0 : settings.accuracy;
  stats.tolerance = starts_coarse(settings, cloud.size()) ? settings.continued_tolerance : settings.tolerance;
  stats.threads = parallel::thread_count(options.threads);
  stats.planned_memory_bytes = planned_memory(settings, points.count, cloud.size());
  if (problem.baseline) {
    stats.epsilon = cloud.frame.length_to_world(problem.baseline->epsilon);
    stats.solver = settings.method == Method::kWnnc ? "wnnc" : "cg";
    stats.harmonics = std::string(1, '1');
    stats.tolerance = problem.baseline->tolerance;
    stats.planned_memory_bytes += baseline_memory(*problem.baseline, problem.spacing, cloud.size());
  }
  if (stats.dropped_non_finite > 0) {
    stats.warnings.push_back(std::to_string(stats.dropped_non_finite) + " points with a non-finite coordinate were left out");
  }
  if (is_flat(cloud)) stats.warnings.emplace_back("the cloud is flat (all points in one plane): which side is outside is a choice");
}

void warn_of_volume(const Problem& problem, Stats& stats) {
  constexpr double kStrongNoise = 0.8;  // spacings; estimate_noise() finds 0.8 to 1 where points fill a volume
  constexpr double kVolume = 2.7;       // between surface and volume
  if (problem.noise <= kStrongNoise * problem.spacing) return;
  if (dimension(problem.cloud.points, Neighbours(problem.cloud.points)) < kVolume) return;
  stats.consistent = false;
  stats.warnings.emplace_back("the points fill a volume: there is no surface, or the noise hides it");
}

// Area vectors, normals and the strength of the field they come from (empty without a refinement), of every point in canonical order.
struct Solution {
  std::vector<Vec3> eta;
  Refinement refinement;
  OpenSheets sheets;
};

void record(const Settings& s, const IterativeResult& result, Stats& stats) {
  stats.converged = result.converged || s.tolerance == 0 || (!result.residuals.empty() && result.residuals.back() <= s.accepted_residual);
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    stats.iterations.push_back({result.kinds[i] == StepKind::kSteepestDescent ? "sd" : "cg", result.residuals[i]});
  }
}

Solution solve_by_baseline(const Problem& problem, Stages& stages, Stats& stats) {
  stages.begin("solve");
  BaselineResult result = solve_baseline(problem.cloud, *problem.baseline, stages);
  stats.converged = result.converged;
  stats.iterations = std::move(result.iterations);
  return {std::move(result.eta), {std::move(result.normals), std::move(result.strength)}, {}};
}

std::vector<Vec3> solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  const Settings& s = problem.settings;
  if (s.dense) {
    const HarmonicValues u = weighted_harmonics(s.harmonics, problem.cloud.points, s.constant_weight);
    DenseResult dense = solve_dense(problem.cloud.points, s.epsilon, u, options.condition_number, stages.cancel());
    stats.converged = true;
    stats.condition_number = dense.condition_number;
    return std::move(dense.eta);
  }
  stages.begin("solve");
  IterativeResult result = solve_coarse_to_fine(problem.cloud.points, problem.cloud.morton, s, stages);
  record(s, result, stats);
  return std::move(result.eta);
}

// Points on open sheets get area vectors along the normals found for them.
void set_sheet_areas(const OpenSheets& sheets, const std::vector<double>& spacing, const std::vector<Vec3>& normals,
                     std::vector<Vec3>& eta) {
  for (std::size_t i = 0; i < sheets.sheet.size(); ++i) {
    if (sheets.sheet[i] == OpenSheets::kNone) continue;
    for (std::size_t a = 0; a < 3; ++a) eta[i][a] = spacing[i] * spacing[i] * normals[i][a];
  }
}

// The same problem on some of the points (ascending).
Problem part_of(const Problem& problem, const std::vector<std::uint32_t>& some, const Options& options) {
  Problem part;
  part.cloud.frame = problem.cloud.frame;
  for (const std::uint32_t i : some) {
    part.cloud.points.push_back(problem.cloud.points[i]);
    part.cloud.morton.push_back(problem.cloud.morton[i]);
  }
  std::vector<std::uint32_t> near = Neighbours(part.cloud.points).of_all(kNear);
  const std::vector<double> local = local_spacing(part.cloud.points, near);
  part.spacing = typical_spacing(local);
  part.noise = problem.noise;
  choose_scales(part, options, std::move(near), local);
  return part;
}

Solution solve_any(const Problem& problem, const Options& options, Stages& stages, Stats& stats);

// Normals at `points` from the field of a solution on a quarter of the cloud's points, beside which the noise is half as large.
std::optional<Refinement> start_on_fewer(const Problem& problem, const Settings& settings, const std::vector<Vec3>& points,
                                         const Options& options, Stages& stages, Stats& stats) {
  if (!settings.start_on_fewer) return std::nullopt;
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = kFewer / 2; i < problem.cloud.size(); i += kFewer) some.push_back(i);
  const Problem part = part_of(problem, some, options);
  const Solution solution = solve_any(part, options, stages, stats);
  const FastSum field(part.cloud.points, part.cloud.morton, Widths(part.settings.polish_width), part.settings.sums, stages.cancel());
  return unit_normals(field.winding_gradient_at(solution.eta, points, stages.cancel()), std::vector<Vec3>(points.size(), Vec3{0, 0, 0}));
}

Solution solve_on_points(const Problem& problem, const Settings& s, const Options& options, Stages& stages, Stats& stats) {
  const std::vector<Vec3>& points = problem.cloud.points;
  Solution solution;
  if (std::optional<Refinement> start = start_on_fewer(problem, s, points, options, stages, stats)) {
    solution.refinement = std::move(*start);
  } else {
    solution.eta = solve(problem, options, stages, stats);
    stages.begin("refine");
    if (s.refinement_width == 0) {
      solution.refinement.normals = normalised(solution.eta);
      return solution;
    }
    FastSum sum(points, problem.cloud.morton, Widths(s.refinement_width), s.sums, stages.cancel());
    solution.refinement = refine_normals(sum, solution.eta);
    if (s.polish_steps == 0) return solution;
  }
  Polished polished = polish(points, problem.cloud.morton, s, problem.local_spacing, {}, solution.refinement, stages);
  std::vector<Vec3>& normals = polished.refinement.normals;
  OpenSheets sheets;
  if (problem.local_spacing.empty()) {  // noisy
    const Neighbours neighbours(points);
    const NoisyCloud noisy{points, neighbours, s.noise, problem.spacing};
    sheets = find_open_sheets(points, {}, &noisy, normals);
    if (!sheets.sheet.empty()) set_sheet_areas(sheets, local_spacing(points), normals, polished.eta);
  } else {
    sheets = find_open_sheets(points, problem.near, nullptr, normals);
    set_sheet_areas(sheets, problem.local_spacing, normals, polished.eta);
    fit_jets(points, problem.near, problem.local_spacing, normals);
    if (sharpen_creases(points, problem.near, problem.local_spacing, normals)) {
      fit_jets(points, problem.near, problem.local_spacing, normals);
    }
  }
  return {std::move(polished.eta), std::move(polished.refinement), std::move(sheets)};
}

// From clusters to their points, whose normals face the side of the cluster's.
void spread_sheets(const OpenSheets& sheets, const Clusters& clusters, const std::vector<Vec3>& cluster_normals, Solution& solution) {
  if (sheets.sheet.empty()) return;
  for (std::size_t i = 0; i < solution.eta.size(); ++i) {
    const std::uint32_t c = clusters.cluster_of[i];
    solution.sheets.sheet.push_back(sheets.sheet[c]);
    solution.sheets.certainty.push_back(sheets.certainty[c]);
    if (sheets.sheet[c] == OpenSheets::kNone) continue;
    Vec3& n = solution.refinement.normals[i];
    const Vec3& side = cluster_normals[c];
    if (n[0] * side[0] + n[1] * side[1] + n[2] * side[2] < kSameSide) n = side;
  }
}

Refinement solve_clusters(const Clusters& clusters, const Settings& s, Stages& stages, Stats& stats) {
  stages.begin("solve");
  FastSum sum(clusters.points, clusters.morton, Widths(s.epsilon), s.first_sums, stages.cancel());
  EnergySystem system(sum, s.damping, s.winding_weight, clusters.multiplicity);
  IterativeResult result = solve_iteratively(system, s.schedule, s.tolerance, {},
                                             [&](int step, int steps, double) { stages.progress(static_cast<double>(step) / steps); });
  record(s, result, stats);
  stages.begin("refine");
  FastSum wide(clusters.points, clusters.morton, Widths(s.refinement_width), s.sums, stages.cancel());
  return refine_normals(wide, system.to_areas(std::move(result.eta)));
}

// Where the kernels are so wide that they see groups of points: the same equations on one point per group, all of whose area vectors are
// equal. The refinement is evaluated at every point.
Solution solve_on_clusters(const Problem& problem, const Settings& s, const Options& options, Stages& stages, Stats& stats) {
  const Clusters clusters = cluster_points(problem.cloud.points, problem.cloud.morton, s.cluster_side);
  std::optional<Refinement> first = start_on_fewer(problem, s, clusters.points, options, stages, stats);
  if (!first) first = solve_clusters(clusters, s, stages, stats);
  Polished polished = polish(clusters.points, clusters.morton, s, {}, clusters.multiplicity, *first, stages);
  std::vector<Vec3>& eta = polished.eta;
  const Neighbours neighbours(problem.cloud.points);
  const NoisyCloud noisy{problem.cloud.points, neighbours, s.noise, problem.spacing};
  OpenSheets sheets;
  if (problem.noise > 0) sheets = find_open_sheets(clusters.points, {}, &noisy, polished.refinement.normals);
  if (!sheets.sheet.empty()) set_sheet_areas(sheets, local_spacing(clusters.points), polished.refinement.normals, eta);
  const FastSum field(clusters.points, clusters.morton, Widths(s.polish_width), s.sums, stages.cancel());
  Solution solution;
  solution.eta.resize(problem.cloud.size());
  for (std::size_t i = 0; i < solution.eta.size(); ++i) {
    const std::uint32_t c = clusters.cluster_of[i];
    for (std::size_t a = 0; a < 3; ++a) solution.eta[i][a] = eta[c][a] / clusters.multiplicity[c];
  }
  solution.refinement = unit_normals(field.winding_gradient_at(eta, problem.cloud.points, stages.cancel()), solution.eta);
  spread_sheets(sheets, clusters, polished.refinement.normals, solution);
  return solution;
}

Solution solve_with(const Problem& problem, const Settings& s, const Options& options, Stages& stages, Stats& stats) {
  if (s.cluster_side > 0) return solve_on_clusters(problem, s, options, stages, stats);
  return solve_on_points(problem, s, options, stages, stats);
}

double unsure_share_of(const Solution& solution) {
  return unsure_share(side_confidence(solution.eta, solution.refinement.normals, solution.refinement.strength));
}

Solution solve_any(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (problem.baseline) return solve_by_baseline(problem, stages, stats);
  Settings s = problem.settings;
  if (!s.start_on_fewer) return solve_with(problem, s, options, stages, stats);
  // The field of fewer points is smooth, and every further step on all points fits more of their noise. Thin walls need the steps.
  s.polish_steps = kStepsAfterFewer;
  const Stats before = stats;
  Solution from_fewer = solve_with(problem, s, options, stages, stats);
  const double unsure = unsure_share_of(from_fewer);
  if (unsure < kFewUnsure) return from_fewer;
  s.start_on_fewer = false;
  s.polish_steps = problem.settings.polish_steps;
  Stats stats_from_zero = before;
  Solution from_zero = solve_with(problem, s, options, stages, stats_from_zero);
  if (unsure_share_of(from_zero) > kLessUnsure * unsure) return from_fewer;
  stats = std::move(stats_from_zero);
  return from_zero;
}

// Solves for some points (ascending) without the others.
void solve_apart(const Problem& problem, const std::vector<std::uint32_t>& some, const Options& options, Stages& stages, Stats& stats,
                 Solution& solution) {
  if (some.size() < kFewestApart) return;
  const Solution apart = solve_any(part_of(problem, some, options), options, stages, stats);
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t i = some[k];
    solution.eta[i] = apart.eta[k];
    solution.refinement.normals[i] = apart.refinement.normals[k];
    solution.refinement.strength[i] = apart.refinement.strength[k];
    const bool open = !apart.sheets.sheet.empty() && apart.sheets.sheet[k] != OpenSheets::kNone;
    solution.sheets.sheet[i] = open ? some[apart.sheets.sheet[k]] : OpenSheets::kNone;
    solution.sheets.certainty[i] = open ? apart.sheets.certainty[k] : 1;
  }
}

// An open sheet makes the equations of everything beside it wrong too. So each sheet is solved for alone, which may show that it was none,
// and then everything else without the sheets.
void solve_sheets_apart(const Problem& problem, const Options& options, Stages& stages, Stats& stats, Solution& solution) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> parts;
  const auto collect = [&] {
    parts.clear();
    for (std::uint32_t i = 0; i < solution.sheets.sheet.size(); ++i) parts[solution.sheets.sheet[i]].push_back(i);
  };
  collect();
  if (parts.size() < 2) return;  // no sheet, or one that is all there is
  for (const auto& [sheet, points] : parts) {
    if (sheet != OpenSheets::kNone) solve_apart(problem, points, options, stages, stats, solution);
  }
  collect();
  if (parts.size() > 1 && parts.count(OpenSheets::kNone) > 0) {
    solve_apart(problem, parts[OpenSheets::kNone], options, stages, stats, solution);
  }
}

// Outliers follow the field, have no area and deserve no confidence.
void add_outliers(const Problem& problem, Stages& stages, Solution& solution, std::vector<float>& confidence) {
  if (problem.outliers.empty()) return;
  const Settings& s = problem.settings;
  const FastSum field(problem.cloud.points, problem.cloud.morton, Widths(s.refinement_width), s.sums, stages.cancel());
  const std::vector<Vec3> none(problem.outliers.size(), Vec3{0, 0, 0});
  const std::vector<Vec3> normals = unit_normals(field.winding_gradient_at(solution.eta, problem.outliers, stages.cancel()), none).normals;
  solution.refinement.normals.insert(solution.refinement.normals.end(), normals.begin(), normals.end());
  solution.eta.insert(solution.eta.end(), none.begin(), none.end());
  confidence.insert(confidence.end(), none.size(), 0.0F);
}

// From the canonical order back to the caller's. A duplicate gets its twin's normal and its share of the area.
void hand_out(const CanonicalCloud& cloud, const std::vector<Vec3>& eta, const std::vector<Vec3>& normals,
              const std::vector<float>& confidence, Orientation& out) {
  const std::size_t n = cloud.point_of.size();
  out.normals.assign(n, Vec3{0, 0, 0});
  out.areas.assign(n, 0);
  out.confidence.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t p = cloud.point_of[i];
    if (p == kNoPoint) continue;
    out.normals[i] = normals[p];
    // One length at a time: the square of a scale may leave the range of double where the area 0 does not.
    const double area = std::hypot(eta[p][0], eta[p][1], eta[p][2]) / cloud.multiplicity[p];
    out.areas[i] = cloud.frame.length_to_world(cloud.frame.length_to_world(area));
    out.confidence[i] = confidence[p];
  }
}

std::string percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

// The sides of points on open sheets do not come from the equations, and their confidence neither.
void add_sheets(const OpenSheets& sheets, std::vector<float>& confidence, Stats& stats) {
  if (sheets.sheet.empty()) return;
  std::size_t open = 0;
  std::size_t undecided = 0;
  for (std::size_t i = 0; i < sheets.sheet.size(); ++i) {
    if (sheets.sheet[i] == OpenSheets::kNone) continue;
    confidence[i] = sheets.certainty[i];
    ++open;
    undecided += sheets.certainty[i] < 1 ? 1 : 0;
  }
  if (open == 0) return;
  const auto all = static_cast<double>(confidence.size());
  stats.open_share = static_cast<double>(open) / all;
  stats.undecided_share = static_cast<double>(undecided) / all;
  std::string warning = "open: " + percent(stats.open_share) + " of the points lie on sheets without an inside; their sides are consistent";
  if (undecided > 0) warning += ", but which one is the outside is a choice: the one that faces up (+z)";
  stats.warnings.push_back(warning);
}

void judge(const CanonicalCloud& cloud, const std::vector<float>& confidence, Stats& stats) {
  double sum = 0;
  for (const float c : confidence) sum += static_cast<double>(c);
  stats.confidence_mean = sum / static_cast<double>(cloud.size());
  stats.confidence_below_half = unsure_share(confidence);
  if (!stats.converged && stats.open_share < 1) {
    stats.warnings.emplace_back("the solver did not reach its tolerance; normals may be less accurate");
  }
  stats.consistent = stats.confidence_below_half + stats.undecided_share <= kManyUnsure;
  if (stats.confidence_below_half > kManyUnsure) {
    stats.warnings.push_back("orientation not consistent: " + percent(stats.confidence_below_half) +
                             " of the points could face either way; the cloud may be open, very noisy or too sparse");
  }
}

Orientation orient_in_arena(const PointsView& points, const Options& options, Stages& stages) {
  Orientation out;
  const Problem problem = prepare(points, options, stages);
  describe(problem, points, options, out.stats);
  require_memory(out.stats.planned_memory_bytes, options);
  Solution solution = solve_any(problem, options, stages, out.stats);
  solve_sheets_apart(problem, options, stages, out.stats, solution);
  std::vector<Vec3>& normals = solution.refinement.normals;
  std::vector<float> confidence = side_confidence(solution.eta, normals, solution.refinement.strength);
  add_sheets(solution.sheets, confidence, out.stats);
  judge(problem.cloud, confidence, out.stats);
  warn_of_volume(problem, out.stats);
  add_outliers(problem, stages, solution, confidence);
  hand_out(problem.cloud, solution.eta, normals, confidence, out);
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
