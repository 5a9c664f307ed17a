// Time, throughput and error of the sums, and how many pairs they consist of. One JSON object per line on stdout.
//   g3r_bench_fast_sum [--points N] [--accuracy A] [--epsilon E (in spacings)] [--threads T] [--order P] [--opening O] [--leaf L] [--cut C]
#include "sum/fast_sum.h"
#include "cloud/canonical_cloud.h"
#include "cloud/morton.h"
#include "cpu/near_field.h"
#include "cpu/parallel.h"
#include "solve/harmonics.h"
#include "tree/interaction_lists.h"

#include "shapes.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>

namespace {

using namespace g3r;

// CPU seconds of the whole process: on a shared machine the wall clock also measures the neighbours. The wall clock tells what threads
// gain.
struct Seconds {
  double cpu = 0;
  double wall = 0;
};

Seconds seconds_of(const auto& work) {
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t start = std::clock();
  work();
  return {static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count()};
}

// Medians of three runs after one that allocates.
Seconds median_seconds(const auto& work) {
  work();
  std::array<double, 3> cpu{};
  std::array<double, 3> wall{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Seconds s = seconds_of(work);
    cpu[i] = s.cpu;
    wall[i] = s.wall;
  }
  std::sort(cpu.begin(), cpu.end());
  std::sort(wall.begin(), wall.end());
  return {cpu[1], wall[1]};
}

// Pairs of points summed one by one and pairs of nodes that meet through expansions, per point.
nlohmann::json pair_counts(const CanonicalCloud& cloud, double width, const SumPlan& plan) {
  const Octree tree = build_octree(cloud.points(), morton_codes(cloud.points()), {width}, plan.leaf_points);
  const InteractionLists lists = build_interaction_lists(tree, tree, plan.opening, plan.reach);
  double near = 0;
  for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
    double sources = 0;
    for (std::size_t k = lists.near_begin[i]; k < lists.near_begin[i + 1]; ++k) sources += tree.nodes[tree.leaves[lists.near[k]]].count();
    near += sources * tree.nodes[tree.leaves[i]].count();
  }
  const auto points = static_cast<double>(cloud.size());
  return {{"near", near / points},
          {"far", static_cast<double>(lists.far.size()) / points},
          {"points_per_leaf", points / static_cast<double>(tree.leaves.size())},
          {"offsets", lists.offsets.size()}};
}

// Relative l2 error against double direct sums at every `step`-th point.
double sampled_error(const std::vector<Vec3>& points, double width, const std::vector<Vec3>& eta, const std::vector<Vec3>& result) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / 200);
  std::vector<Vec3> targets;
  std::vector<Vec3> got;
  for (std::size_t i = 0; i < points.size(); i += step) {
    targets.push_back(points[i]);
    got.push_back(result[i]);
  }
  const std::vector<Vec3> truth = direct_sum::winding_gradient(points, width, eta, targets);
  double error = 0;
  double size = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      error += (got[i][a] - truth[i][a]) * (got[i][a] - truth[i][a]);
      size += truth[i][a] * truth[i][a];
    }
  }
  return std::sqrt(error / size);
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t n = 500000;
  double accuracy = 1e-3;
  double epsilon = 0.4;
  int threads = 1;
  int order = -1;
  double opening = -1;
  int leaf = -1;
  double cut = -1;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string flag = argv[i];
    const double value = std::atof(argv[i + 1]);
    if (flag == "--points") n = static_cast<std::size_t>(value);
    if (flag == "--accuracy") accuracy = value;
    if (flag == "--epsilon") epsilon = value;
    if (flag == "--threads") threads = static_cast<int>(value);
    if (flag == "--order") order = static_cast<int>(value);
    if (flag == "--opening") opening = value;
    if (flag == "--cut") cut = value;
    if (flag == "--leaf") leaf = static_cast<int>(value);
  }
  const shapes::Surface surface = shapes::torus(n, 0.6, 0.25, 5);
  parallel::with_threads(threads, [&] {
    CanonicalCloud cloud;
    const Seconds sort = seconds_of([&] { cloud = canonical_cloud(surface.points); });
    const double area = 4 * 9.8696 * 0.6 * 0.25 * cloud.frame.scale * cloud.frame.scale;
    const double h = std::sqrt(area / static_cast<double>(n));
    SumPlan plan = sum_plan(accuracy, n);
    if (order >= 0) plan.order = order;
    if (opening >= 0) plan.opening = opening;
    if (cut >= 0) plan.cut = cut;
    if (leaf >= 0) plan.leaf_points = static_cast<std::size_t>(leaf);
    std::unique_ptr<FastSum> sum;
    const Seconds build = seconds_of([&] { sum = std::make_unique<FastSum>(cloud.points(), Widths(epsilon * h), plan); });
    std::vector<Vec3> eta(cloud.size());
    shapes::Random random(1);
    for (Vec3& v : eta) v = random.direction();
    const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 2), cloud.points());
    std::vector<double> q;
    std::vector<Vec3> at;
    std::vector<Vec3> s;
    std::vector<double> w;
    const Seconds green = median_seconds([&] { q = sum->green(u, eta); });
    const Seconds adjoint = median_seconds([&] { at = sum->green_adjoint(u, q); });
    const Seconds stokes = median_seconds([&] { sum->stokes_winding(eta, s, w); });
    const Seconds w_adjoint = median_seconds([&] { at = sum->winding_adjoint(w); });
    const Seconds gradient = median_seconds([&] { at = sum->winding_gradient(eta); });
    const double points = static_cast<double>(cloud.size());
    const auto seconds = [&](double Seconds::*clock) {
      return nlohmann::json{{"sort", sort.*clock},
                            {"build", build.*clock},
                            {"green", green.*clock},
                            {"green_adjoint", adjoint.*clock},
                            {"stokes_winding", stokes.*clock},
                            {"winding_adjoint", w_adjoint.*clock},
                            {"gradient", gradient.*clock}};
    };
    nlohmann::json out{{"points", cloud.size()},
                       {"epsilon_over_h", epsilon},
                       {"threads", threads},
                       {"accuracy", accuracy},
                       {"order", plan.order},
                       {"opening", plan.opening},
                       {"cut", plan.cut},
                       {"leaf", plan.leaf_points},
                       {"isa", cpu::instruction_set()},
                       {"seconds", seconds(&Seconds::cpu)},
                       {"wall_seconds", seconds(&Seconds::wall)},
                       {"points_per_second",
                        {{"green_pair", points / (green.cpu + adjoint.cpu)},
                         {"energy", points / (stokes.cpu + w_adjoint.cpu)},
                         {"gradient", points / gradient.cpu}}},
                       {"pairs_per_point", pair_counts(cloud, epsilon * h, plan)},
                       {"gradient_error", sampled_error(cloud.points(), epsilon * h, eta, at)}};
    std::cout << out.dump() << "\n";
  });
}
