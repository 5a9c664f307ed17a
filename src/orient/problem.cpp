#include "orient/problem.h"

#include "cloud/neighbours.h"
#include "cloud/noise.h"
#include "cloud/outliers.h"
#include "cloud/spacing.h"

#include <g3r/error.h>

#include <memory>
#include <optional>
#include <utility>

namespace g3r {
namespace {

// What the steps after noise and outliers need. `near`: kSpacingNeighbours nearest of every point; `local`: local_spacing().
void choose_scales(Problem& problem, const Options& options, std::vector<std::uint32_t> near, const std::vector<double>& local) {
  problem.settings = choose_settings(options, problem.cloud, problem.spacing, problem.noise, problem.outliers.size());
  if (problem.noise > 0 || problem.settings.polish_steps == 0) return;
  problem.local_spacing = smoothed_spacing(local, near);
  problem.near = std::move(near);
}

}  // namespace

Problem prepare(const PointsView& points, const Options& options, Stages& stages) {
  Problem problem;
  stages.begin("build");
  problem.cloud = canonical_cloud(points);
  stages.check();
  const std::vector<Vec3>& cloud = problem.cloud.points;
  std::unique_ptr<Neighbours> neighbours;
  std::vector<std::uint32_t> near;
  std::vector<double> local;
  const auto look_around = [&] {
    neighbours = std::make_unique<Neighbours>(cloud);
    near = neighbours->of_all(kSpacingNeighbours);
    local = local_spacing(cloud, near);
  };
  look_around();
  problem.spacing = typical_spacing(local);
  const StepSet without = parse_steps(options.without);
  bool outliers_wanted = options.preset != Preset::kPaper && !is_baseline(options.method) && !contains(without, Step::kOutliers);
  while (outliers_wanted) {
    std::vector<Vec3> removed = remove_points(problem.cloud, find_outliers(cloud, near, local, problem.spacing));
    if (removed.empty()) break;
    problem.outliers.insert(problem.outliers.begin(), removed.begin(), removed.end());
    outliers_wanted = refit_frame(problem.cloud, problem.outliers);  // far ones may have hidden nearer ones
    look_around();
    if (outliers_wanted) problem.spacing = typical_spacing(local);
  }
  if (const std::optional<double> given = given_noise(options.noise, problem.cloud, problem.spacing)) {
    problem.noise = *given;
  } else if (options.preset != Preset::kPaper && !contains(without, Step::kNoise)) {
    problem.noise = estimate_noise(cloud, *neighbours, problem.spacing);
  }
  if (options.method == Method::kAuto && options.preset != Preset::kPaper && !contains(without, Step::kSites)) {
    problem.line_distance = surface_distance(cloud, *neighbours, problem.spacing);
  }
  choose_scales(problem, options, std::move(near), local);
  if (!options.wnnc_widths.empty() && options.method != Method::kWnnc) throw InvalidInput("wnnc_widths belong to the method wnnc");
  if (is_baseline(options.method)) {
    const double epsilon = options.epsilon.unit == Length::Unit::kAuto ? 0 : problem.settings.epsilon;
    problem.baseline = choose_baseline(options, epsilon, problem.spacing, problem.settings.sums);
  }
  return problem;
}

Problem with_noise(const Problem& problem, double noise, const Options& options) {
  Problem same;
  same.cloud = problem.cloud;
  same.outliers = problem.outliers;
  same.spacing = problem.spacing;
  same.noise = noise;
  std::vector<std::uint32_t> near = Neighbours(same.cloud.points).of_all(kSpacingNeighbours);
  const std::vector<double> local = local_spacing(same.cloud.points, near);
  choose_scales(same, options, std::move(near), local);
  return same;
}

Problem on_sites(const Problem& problem, const Sites& sites, const Options& options) {
  Problem coarse;
  coarse.cloud.frame = problem.cloud.frame;
  coarse.cloud.points = sites.points;
  coarse.cloud.morton = sites.morton;
  const Neighbours neighbours(sites.points);
  coarse.spacing = typical_spacing(sites.spacing);
  const std::optional<double> given = given_noise(options.noise, problem.cloud, problem.spacing);
  coarse.noise = given                                              ? *given
                 : contains(problem.settings.without, Step::kNoise) ? 0
                                                                    : estimate_noise(sites.points, neighbours, coarse.spacing);
  choose_scales(coarse, options, neighbours.of_all(kSpacingNeighbours), sites.spacing);
  return coarse;
}

Problem part_of(const Problem& problem, const std::vector<std::uint32_t>& some, const Options& options) {
  Problem part;
  part.cloud.frame = problem.cloud.frame;
  for (const std::uint32_t i : some) {
    part.cloud.points.push_back(problem.cloud.points[i]);
    part.cloud.morton.push_back(problem.cloud.morton[i]);
  }
  std::vector<std::uint32_t> near = Neighbours(part.cloud.points).of_all(kSpacingNeighbours);
  const std::vector<double> local = local_spacing(part.cloud.points, near);
  part.spacing = typical_spacing(local);
  part.noise = problem.noise;
  part.outliers = problem.outliers;  // those of the whole cloud: the part was solved for among them
  Options same = options;
  if (options.epsilon.unit == Length::Unit::kPercent) {  // of the whole cloud's box
    same.epsilon = {Length::Unit::kInput, problem.cloud.frame.length_to_world(problem.settings.epsilon)};
  }
  choose_scales(part, same, std::move(near), local);
  return part;
}

}  // namespace g3r
