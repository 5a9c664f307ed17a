// The whole program on one page: one line per step (orient_in_arena).
#include "base/percent.h"
#include "base/stages.h"
#include "base/vector.h"
#include "baselines/baseline.h"
#include "cloud/clusters.h"
#include "cloud/noise.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "field/areas.h"
#include "mesh/findings.h"
#include "orient/apply_hints.h"
#include "orient/confidence.h"
#include "orient/hints.h"
#include "orient/open_surfaces.h"
#include "orient/open_to_views.h"
#include "orient/polish.h"
#include "orient/problem.h"
#include "orient/solution.h"
#include "orient/start.h"
#include "orient/walls.h"
#include "solve/refine.h"
#include "sum/device_scope.h"
#include "sum/fast_sum.h"

#include <g3r/g3r.h>
#include <g3r/names.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace g3r {
namespace {

// Times the estimate, the scatter that speaks against it; times the scatter, the noise that is tried: kernels have to hide all of it.
constexpr double kAboveScatter = 1.4;
// Of the doubt that there is, up to which another noise is taken: chance does not halve it.
constexpr double kClearlyLess = 0.5;
// The same for more noise than the points speak for: noise hides thin walls and all doubt about them.
constexpr double kHardlyAny = 0.2;
// Points up to which shape looks like noise, so that none is tried too: with more it costs time and is never taken.
constexpr std::size_t kFewPoints = 2500;
// Noise that kernels are made for, from one try of narrower ones to the next: the kernels, which follow its square, by sqrt(2).
const double kNarrower = std::exp2(-0.25);
// Dimension from which points fill a volume: cubes and balls have 2.57 and more, surfaces under noise of 2 h at most 2.45.
constexpr double kVolume = 2.55;

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
  stats.noise = cloud.frame.length_to_world(std::max(problem.noise, problem.view_noise));
  stats.epsilon = cloud.frame.length_to_world(settings.epsilon.typical());
  stats.preset = name_of(options.preset);
  stats.method = name_of(settings.method);
  stats.solver = name_of(settings.dense ? Solver::kDense : Solver::kConjugateGradient);
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
  if (problem.spacing <= kLeastSpacing) {
    stats.warnings.emplace_back(
        "the points are closer together than a millionth of the cloud's width, too close for the solver: "
        "treat parts that are far apart one by one");
  }
  if (is_flat(cloud)) stats.warnings.emplace_back("the cloud is flat (all points in one plane): which side is outside is a choice");
}

void warn_of_volume(const Problem& problem, Stats& stats) {
  if (problem.settings.cluster_side == 0) return;  // volumes look like noise of 0.75 spacings and more
  if (dimension(problem.cloud.set) < kVolume) return;
  stats.consistent = false;
  stats.warnings.emplace_back("the points fill a volume: there is no surface, or the noise hides it");
}

// The gradient of the winding field at the outliers: that of the groups of points where these were solved for, whose kernels are so wide
// that the pairs of single points would fill the memory.
std::vector<Vec3> gradient_at_outliers(const Problem& problem, const std::vector<Vec3>& eta, Stages& stages) {
  const Settings& s = problem.settings;
  const PointSet& set = problem.cloud.set;
  const Widths widths(s.refinement_width.typical());
  if (s.cluster_side == 0) {
    return FastSum(set.points(), widths, s.sums, stages.cancel()).winding_gradient_at(eta, problem.outliers, stages.cancel());
  }
  const Clusters clusters = cluster_points(set.points(), s.cluster_side);
  std::vector<Vec3> together(clusters.points.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < eta.size(); ++i) {
    Vec3& sum = together[clusters.cluster_of[i]];
    sum = vector::add(sum, eta[i]);
  }
  return FastSum(clusters.points, widths, s.sums, stages.cancel()).winding_gradient_at(together, problem.outliers, stages.cancel());
}

// Outliers follow the field, have no area and deserve no confidence.
void add_outliers(const Problem& problem, Stages& stages, Solution& solution, std::vector<float>& confidence) {
  if (problem.outliers.empty()) return;
  const std::vector<Vec3> none(problem.outliers.size(), Vec3{0, 0, 0});
  const std::vector<Vec3> normals = unit_normals(gradient_at_outliers(problem, solution.eta, stages), none).normals;
  solution.refinement.normals.insert(solution.refinement.normals.end(), normals.begin(), normals.end());
  solution.eta.insert(solution.eta.end(), none.begin(), none.end());
  confidence.insert(confidence.end(), none.size(), 0.0F);
}

// The solve is for normals; the lengths of its vectors vary with the sample. Earlier methods keep theirs.
bool replaces_areas(const Problem& problem) {
  return problem.settings.method == Method::kEnergy && !contains(problem.settings.without, Step::kAreas);
}

void replace_areas(const Problem& problem, Stages& stages, Solution& solution) {
  if (!replaces_areas(problem)) return;
  solution.eta = area_vectors(problem.cloud.set, solution.refinement.normals, solution.open_surfaces, stages.cancel());
}

// From the canonical order back to the caller's. A duplicate gets its twin's normal and its share of the area.
void hand_out(const CanonicalCloud& cloud, const std::vector<Vec3>& eta, const std::vector<Vec3>& normals,
              const std::vector<float>& confidence, Orientation& out) {
  const std::size_t n = cloud.point_of.size();
  out.normals.assign(n, Vec3{0, 0, 0});
  out.areas.assign(n, 0);
  out.confidence.assign(n, 0);
  parallel::for_all(n, [&](std::size_t i) {
    const std::uint32_t p = cloud.point_of[i];
    if (p == kNoPoint) return;
    out.normals[i] = normals[p];
    // One length at a time: the square of a scale may leave the range of double where the area 0 does not.
    const double area = std::hypot(eta[p][0], eta[p][1], eta[p][2]) / cloud.multiplicity[p];
    out.areas[i] = cloud.frame.length_to_world(cloud.frame.length_to_world(area));
    out.confidence[i] = confidence[p];
  });
}

// Which of the caller's points lie on open surfaces.
std::vector<std::uint8_t> open_points(const CanonicalCloud& cloud, const OpenSurfaces& surfaces) {
  std::vector<std::uint8_t> open(cloud.point_of.size(), 0);
  for (std::size_t i = 0; i < open.size(); ++i) {
    const std::uint32_t p = cloud.point_of[i];
    if (surfaces.is_open(p)) open[i] = 1;
  }
  return open;
}

// The sides of points on open surfaces do not come from the equations, and their confidence neither.
void add_open_surfaces(const OpenSurfaces& surfaces, std::vector<float>& confidence, Stats& stats) {
  if (surfaces.part.empty()) return;
  std::size_t open = 0;
  std::size_t undecided = 0;
  std::size_t agreed = 0;
  for (std::size_t i = 0; i < surfaces.part.size(); ++i) {
    if (!surfaces.is_open(i)) {
      confidence[i] *= surfaces.certainty[i];
      continue;
    }
    confidence[i] = surfaces.certainty[i];
    ++open;
    agreed += surfaces.agrees[i];
    undecided += surfaces.certainty[i] <= kUndecided ? 1 : 0;
  }
  if (open == 0) return;
  const auto all = static_cast<double>(confidence.size());
  stats.open_share = static_cast<double>(open) / all;
  stats.undecided_share = static_cast<double>(undecided) / all;
  stats.warnings.push_back("open: " + percent(stats.open_share) + " of the points lie on surfaces without an inside; " +
                           (agreed == open ? "their sides are consistent" : "their sides do not agree everywhere"));
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

void judge(const OpenSurfaces& surfaces, const std::vector<float>& confidence, Stats& stats) {
  double sum = 0;
  for (const float c : confidence) sum += static_cast<double>(c);
  stats.confidence_mean = sum / static_cast<double>(confidence.size());
  stats.confidence_below_half = unsure_share(confidence);
  const double unsure = unsure_share(surfaces, confidence);
  if (stats.open_share == 1) stats.converged = true;  // no side and no direction comes from the equations
  if (!stats.converged) {
    stats.warnings.emplace_back("the solver did not reach its tolerance; normals may be less accurate");
  }
  stats.consistent = unsure + stats.undecided_share <= kManyUnsure;
  if (unsure > kManyUnsure) {
    stats.warnings.push_back("orientation not consistent: " + percent(unsure) +
                             " of the points could face either way; the cloud may be open, very noisy or too sparse");
  }
}

// The share of the wanted points for which is_so(i); of all, if none is.
template <class IsSo>
double share_of_wanted(const Problem& problem, const IsSo& is_so) {
  const std::vector<std::uint8_t>& wanted = problem.known.wanted;
  const bool all = std::none_of(wanted.begin(), wanted.end(), [](std::uint8_t w) { return w != 0; });
  std::size_t points = 0;
  std::size_t so = 0;
  for (std::size_t i = 0; i < problem.cloud.size(); ++i) {
    if (!all && wanted[i] == 0) continue;
    ++points;
    so += is_so(i) ? 1 : 0;
  }
  return static_cast<double>(so) / static_cast<double>(points);
}

struct Oriented {
  Solution solution;
  std::vector<float> confidence;
  double doubt = 0;   // share of the wanted points that could face either way by their own equations, or lie on open surfaces
  double agreed = 0;  // share of the wanted points that lie on open surfaces whose sides agree: these could face either way, but together
  MeanExcess about_walls;  // of the heights of noisy points about what was found, if not all of it is open
};

Solution solve_problem(const Problem& problem, const Options& options, Stages& stages, Stats& stats) {
  if (is_seen_in_noise(problem)) return solve_by_sight(problem, stages, stats);
  Solution solution = solve(problem, options, stages, stats);
  solve_open_surfaces_apart(problem, options, stages, stats, solution);
  if (const Views& views = problem.cloud.set.views(); views.known()) {
    open_to_views(views, problem.cloud.points(), solution.open_surfaces, solution.refinement.normals, solution.eta);
  }
  return solution;
}

// How certain the sides are, and what there is to say of it.
Oriented assess(const Problem& problem, Solution solution, Stats& stats) {
  Oriented out;
  out.solution = std::move(solution);
  const Refinement& refined = out.solution.refinement;
  if (problem.noise > 0) {
    const Sums around = sums_over(problem.cloud.set.near(), out.solution.eta);
    out.confidence = side_confidence(around.vectors, refined.normals, refined.strength, around.lengths);
  } else {
    const std::vector<double> areas = point_areas(problem.settings, problem.cloud.set.smoothed_spacing());
    out.confidence = side_confidence(out.solution.eta, refined.normals, refined.strength, areas);
  }
  const OpenSurfaces& surfaces = out.solution.open_surfaces;
  add_open_surfaces(surfaces, out.confidence, stats);
  const auto is_open = [&](std::size_t i) { return surfaces.is_open(i); };
  out.agreed = share_of_wanted(problem, [&](std::size_t i) { return is_open(i) && surfaces.agrees[i] != 0; });
  out.doubt = share_of_wanted(problem, [&](std::size_t i) { return out.confidence[i] < kUndecided; }) + share_of_wanted(problem, is_open);
  if (problem.noise > 0 && stats.open_share < 1 && !problem.cloud.set.views().known()) {
    out.about_walls = excess_about_walls(problem.cloud.set, refined.normals, problem.noise, problem.spacing);
  }
  const bool hides_walls = out.about_walls.is_two_walls();
  if (!contains(problem.settings.without, Step::kCertificate)) {
    certify_sides(surfaces, hides_walls, out.confidence);
    limit_to_evidence(problem.cloud.size(), out.confidence);
  }
  if (hides_walls) {
    stats.warnings.emplace_back(
        "two layers: the points lie about their surface as about two that are too close together for their noise: a wall that needs more "
        "points or less noise, or scans that have to be aligned");
  }
  judge(surfaces, out.confidence, stats);
  return out;
}

// Gives up the memory of what the confidence has of a solution.
void release(const Problem& problem, Solution& solution) {
  std::vector<double>().swap(solution.refinement.strength);
  if (replaces_areas(problem)) std::vector<Vec3>().swap(solution.eta);
}

bool may_try_noises(const Problem& problem, const Options& options) {
  const bool on_points = problem.line_distance == 0;  // sites have a noise of their own
  const bool sides_known = problem.cloud.set.views().known();
  return on_points && !sides_known && problem.settings.method == Method::kEnergy && options.preset != Preset::kPaper &&
         options.epsilon.unit == Length::Unit::kAuto && options.noise.unit == Length::Unit::kAuto && options.schedule.empty() &&
         !contains(problem.settings.without, Step::kNoise) && !contains(problem.settings.without, Step::kNoiseChoice);
}

struct OtherNoise {
  double noise = 0;
  double most_doubt = kClearlyLess;  // of the doubt with the estimate, up to which it is taken
};

// What to try where the sides of many points are unsure. No noise: few points on much shape look noisy, but not rounded. More: what
// scatters most, of noise that differs from place to place and of scans that do not fit onto each other, looks like shape beside what
// scatters least, which the estimate goes by; what rounding leaves, where exact terraces hide it; and noise of a spacing or so can turn
// whole shells, in cavities for example, in the narrow polish. A surface that is open at the estimate may be closed at such a scatter, but
// not at one that kernels hide anyway.
std::vector<OtherNoise> other_noises(const Problem& problem, const Options& options, const Oriented& found) {
  if (!may_try_noises(problem, options) || found.doubt < kDoubtful) return {};
  const PointSet& set = problem.cloud.set;
  const double scatter = largest_scatter(set);
  const double least = noise_of_clean_widths() * problem.spacing;  // less blurs no less, and leaves more unsure
  const double unsure = found.doubt - found.agreed;
  std::vector<OtherNoise> noises;
  const double rounding = rounding_deviation(set);
  if (rounding > problem.noise) noises.push_back({rounding});
  if (kAboveScatter * scatter <= least && unsure < kDoubtful) return noises;
  if (set.size() <= kFewPoints && problem.noise > rounding_noise(set)) noises.push_back({0});
  if (scatter > kAboveScatter * problem.noise) {
    noises.push_back({std::max(kAboveScatter * scatter, least)});
  } else if (problem.noise > 0 && unsure >= kDoubtful) {
    noises.push_back({kAboveScatter * problem.noise, kHardlyAny});
  }
  return noises;
}

// A problem, its solution and what there is to say of them.
struct Attempt {
  Problem problem;
  Oriented oriented;
  Stats solved;  // before the sides were assessed
  Stats stats;
};

Attempt attempt(Problem problem, const PointsView& points, const Options& options, Stages& stages) {
  Attempt out{std::move(problem), {}, {}, {}};
  describe(out.problem, points, options, out.solved);
  require_memory(out.solved.planned_memory_bytes, options);
  const PointSet& set = out.problem.cloud.set;
  static_cast<void>(set.smoothed_spacing());  // what solve and areas need of the neighbours,
  static_cast<void>(set.spacing());           // and what the certificate does
  make_room_for_sums(set);
  Solution solution = solve_problem(out.problem, options, stages, out.solved);
  out.stats = out.solved;
  out.oriented = assess(out.problem, std::move(solution), out.stats);
  if (!is_projected(out.problem)) release(out.problem, out.oriented.solution);
  return out;
}

// The walls that were found, for noise of so much.
PlacesOnWalls walls_of(const Attempt& found, double noise) {
  return fit_places(found.problem.cloud.set, found.oriented.solution.refinement.normals, noise, found.problem.spacing);
}

// Kernels that hide the noise take walls closer together than they are wide for one: then points lie farther from the surface that is
// found than noise carries them, or lie about it as about two. Where that is so, narrower kernels are tried until it is not (the
// discrepancy principle of Morozov, "On the solution of functional equations by the method of regularization", 1966), or until they are as
// narrow as those of clean clouds. If points come to lie farther away again before, it was shape, creases for example, and the first ones
// stay. Half of the points of merged walls face the wrong way and turn when the walls are separated: where fewer do than half of a doubtful
// share, and there is as much doubt as before, points far from the surface have another cause, such as noise that was estimated too low,
// and narrower kernels only fit the noise.
Attempt separate_walls(Attempt found, const PointsView& points, const Options& options, Stages& stages) {
  const double noise = found.problem.noise;
  const bool is_open = found.stats.open_share > 0;  // and has no walls
  bool hides = found.oriented.about_walls.is_two_walls();
  if (noise == 0 || is_open || !may_try_noises(found.problem, options)) return found;
  if (found.oriented.doubt < kDoubtful && !hides) return found;
  const double least = noise_of_clean_widths() * found.problem.spacing;
  const PlacesOnWalls first = walls_of(found, noise);
  double before = misfit(first);
  std::optional<Attempt> separated;
  for (double hidden = noise * kNarrower; before > 1 && hidden > least; hidden *= kNarrower) {
    Attempt tried = attempt(with_noise(found.problem, hidden, options), points, options, stages);
    const PlacesOnWalls walls = walls_of(tried, noise);
    const double after = misfit(walls);
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

// Thin walls and layers of scans that do not fit onto each other look alike from near. But few sides of walls are unsure when they are
// solved for as what they are, of layers when they are solved for as noise. More noise may also make one surface of thin walls, of which
// all sides are sure: it is not taken where points then lie about that surface as about two.
Attempt orient_with_best_noise(const PointsView& points, Known known, const Options& options, Stages& stages) {
  Attempt best = attempt(prepare(points, std::move(known), options, stages), points, options, stages);
  const double estimate = best.problem.noise;
  best = separate_walls(std::move(best), points, options, stages);
  const bool has_walls = best.problem.noise < estimate || best.oriented.about_walls.is_two_walls();
  const double doubt = best.oriented.doubt;
  // Kernels for this estimate, or those of clean clouds, hide so much noise, and merge what it merges.
  const double hidden_anyway = std::max(estimate, noise_of_clean_widths() * best.problem.spacing);
  for (const OtherNoise& other : other_noises(best.problem, options, best.oriented)) {
    if (has_walls && other.noise > best.problem.noise) continue;
    Attempt tried = attempt(with_noise(best.problem, other.noise, options), points, options, stages);
    const double most = std::min(other.most_doubt * doubt, best.oriented.doubt);
    const bool merges_walls = kNarrower * other.noise > hidden_anyway && tried.oriented.about_walls.may_be_two_walls();
    if (tried.oriented.doubt <= most && !merges_walls) best = std::move(tried);
  }
  return best;
}

Orientation orient_in_arena(const PointsView& points, Known known, const Options& options, Stages& stages,
                            std::vector<std::uint8_t>* open) {
  require_sound(options.hints, points.count);
  Attempt best = orient_with_best_noise(points, std::move(known), options, stages);
  if (polish_projected(best.problem, options, stages, best.oriented.solution)) {
    best.stats = best.solved;
    best.oriented = assess(best.problem, std::move(best.oriented.solution), best.stats);
  }
  release(best.problem, best.oriented.solution);
  Solution& solution = best.oriented.solution;
  std::vector<float>& confidence = best.oriented.confidence;
  Orientation out;
  out.stats = std::move(best.stats);
  const bool is_whole = best.problem.known.wanted.empty();  // what surroundings and a part of a cloud look like says nothing of it
  fit_noisy_surface(best.problem, stages, solution);
  if (is_whole) warn_of_sampling(best.problem.cloud, solution.refinement.normals, out.stats);  // while neighbours are known
  replace_areas(best.problem, stages, solution);
  apply_hints(best.problem, options, solution, confidence, out.stats, stages.cancel());
  if (is_whole) warn_of_volume(best.problem, out.stats);
  add_outliers(best.problem, stages, solution, confidence);
  if (open != nullptr) *open = open_points(best.problem.cloud, solution.open_surfaces);
  hand_out(best.problem.cloud, solution.eta, solution.refinement.normals, confidence, out);
  stages.finish(out.stats);
  return out;
}

}  // namespace

Orientation orient(const PointsView& points, const Options& options, const Monitor& monitor) {
  return orient_from(points, {}, options, monitor);
}

Orientation orient_from(const PointsView& points, Known known, const Options& options, const Monitor& monitor,
                        std::vector<std::uint8_t>* open) {
  Stages stages(monitor);
  return parallel::with_threads(options.threads, [&] {
    const gpu::Scope device(options.device, points.count);
    stages.time_device([&device] { return device.seconds(); });
    Orientation out = orient_in_arena(points, std::move(known), options, stages, open);
    device.describe(out.stats);
    return out;
  });
}

Stats plan(const PointsView& points, const Options& options) {
  const Monitor monitor;
  Stages stages(monitor);
  return parallel::with_threads(options.threads, [&] {
    Stats stats;
    describe(prepare(points, {}, options, stages), points, options, stats);
    stages.finish(stats);
    return stats;
  });
}

}  // namespace g3r
