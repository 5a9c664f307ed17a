#include "measure.h"

#include <g3r/error.h>
#include <g3r/metrics.h>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "base/vector.h"
#include "ceiling.h"

namespace g3r::bench {

namespace {

constexpr std::size_t kMeshSamples = 200000;
constexpr std::array<double, 4> kQuantiles = {0.50, 0.90, 0.95, 0.99};
constexpr float kSure = 0.9F;  // confidence above which a side is promised
constexpr double kDegrees = 180 / 3.14159265358979323846;

/// Processor time of this process so far.
double cpu_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Stops the clock when the mesh begins, or never.
Monitor watch_for_mesh(double start, double& cpu_seconds) {
  Monitor monitor;
  monitor.progress = [start, &cpu_seconds](std::string_view stage, double) {
    if (stage != "mesh") cpu_seconds = cpu_time() - start;
    return true;
  };
  return monitor;
}

// How many of these points are sure of their side, as a share of `all`.
double sure_share(const std::vector<float>& confidence, std::size_t all) {
  const auto sure = std::count_if(confidence.begin(), confidence.end(), [](float c) { return c > kSure; });
  return static_cast<double>(sure) / static_cast<double>(all);
}

void score_points(const Orientation& orientation, const Input& input, Row& row) {
  const std::vector<Vec3> normals(orientation.normals.begin(), orientation.normals.begin() + static_cast<std::ptrdiff_t>(input.surface));
  const NormalScore score = score_normals(normals, input.normals);
  row.ae = score.ae;
  row.pco = score.pco;
  std::vector<double> angles;
  std::vector<float> right, wrong;
  double wrong_and_thin = 0;
  for (std::size_t i = 0; i < input.surface; ++i) {
    const double cosine = vector::dot(vector::normalised(normals[i]), input.normals[i]);
    angles.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees);
    (cosine > 0 ? right : wrong).push_back(orientation.confidence[i]);
    if (cosine <= 0 && input.thin[i]) ++wrong_and_thin;
  }
  if (!wrong.empty()) row.wrong_thin = wrong_and_thin / static_cast<double>(wrong.size());
  std::sort(angles.begin(), angles.end());
  for (std::size_t q = 0; q < kQuantiles.size(); ++q) {
    row.angle_quantiles[q] = angles[static_cast<std::size_t>(kQuantiles[q] * static_cast<double>(angles.size() - 1))];
  }
  row.right_and_sure = sure_share(right, input.surface);
  row.wrong_and_sure = sure_share(wrong, input.surface);
  if (!right.empty() && !wrong.empty()) row.confidence_auc = area_under_curve(std::move(right), std::move(wrong));
  const auto outliers = orientation.confidence.begin() + static_cast<std::ptrdiff_t>(input.surface);
  if (outliers != orientation.confidence.end()) {
    const auto count = static_cast<double>(orientation.confidence.end() - outliers);
    row.outlier_confidence = std::accumulate(outliers, orientation.confidence.end(), 0.0) / count;
  }
}

MeshRow score_reconstruction(const Mesh& mesh, const Mesh& truth, std::uint64_t seed) {
  MeshRow row;
  row.check = check_mesh(mesh);
  row.check.self_intersections = count_self_intersections(mesh);
  const MeshScore score = score_mesh(mesh, truth, {kMeshSamples, seed});
  row.chamfer = score.chamfer;
  row.ae = score.ae;
  row.hausdorff = score.hausdorff;
  return row;
}

/// The mesher alone. Outliers have no true normal and are not given to it.
void mesh_true_normals(const Mesh& truth, const Input& input, const Variant& variant, std::uint64_t seed, Row& row) {
  const std::vector<Vec3> points(input.points.begin(), input.points.begin() + static_cast<std::ptrdiff_t>(input.surface));
  const double start = cpu_time();
  const auto clock = std::chrono::steady_clock::now();
  try {
    const Mesh mesh = mesh_oriented(points, input.normals, variant.mesh);
    const double cpu = cpu_time() - start;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    row.mesh = score_reconstruction(mesh, truth, seed);
    row.mesh->seconds = seconds;
    row.mesh->cpu_seconds = cpu;
  } catch (const Error& error) {
    row.mesh_error = error.what();
  }
  row.pco = 1;
}

}  // namespace

double area_under_curve(std::vector<float> high, std::vector<float> low) {
  std::sort(high.begin(), high.end());
  std::sort(low.begin(), low.end());
  double above = 0;
  std::size_t below = 0, not_above = 0;  // of low: below the item of high, and below or equal
  for (const float value : high) {
    while (below < low.size() && low[below] < value) ++below;
    while (not_above < low.size() && low[not_above] <= value) ++not_above;
    above += static_cast<double>(below) + static_cast<double>(not_above - below) / 2;
  }
  return above / static_cast<double>(high.size()) / static_cast<double>(low.size());
}

Row measure(const std::string& model, const Mesh& truth, const Input& input, const InputKind& kind, const Variant& variant, bool with_mesh,
            std::uint64_t seed) {
  Row row;
  row.model = model;
  row.input = kind.name;
  row.method = variant.name;
  row.points = input.points.size();
  row.thin = static_cast<double>(std::count(input.thin.begin(), input.thin.end(), true)) / static_cast<double>(input.thin.size());
  try {
    if (variant.true_normals) {
      if (!with_mesh) throw InvalidInput("the method true measures the mesher: give --mesh");
      mesh_true_normals(truth, input, variant, seed, row);
      return row;
    }
    if (variant.ceiling) {
      Orientation best;
      best.normals = ceiling_normals(truth, input, seed);
      best.confidence.assign(input.points.size(), 0);
      score_points(best, input, row);
      return row;
    }
    Reconstruction result;
    const double start = cpu_time();
    const Monitor monitor = watch_for_mesh(start, row.cpu_seconds);
    if (with_mesh) {
      try {
        result = reconstruct(input.points, variant.options, variant.mesh, monitor);
        const double cpu = cpu_time() - start - row.cpu_seconds;
        row.mesh = score_reconstruction(result.mesh, truth, seed);
        row.mesh->cpu_seconds = cpu;
        for (const auto& [stage, seconds] : result.orientation.stats.seconds) row.mesh->seconds += stage == "mesh" ? seconds : 0;
      } catch (const Error& error) {  // the normals are still worth a row
        row.mesh_error = error.what();
        result.orientation = orient(input.points, variant.options);
      }
    } else {
      result.orientation = orient(input.points, variant.options, monitor);
    }
    row.stats = result.orientation.stats;
    for (const auto& [stage, seconds] : row.stats.seconds) row.seconds += stage == "mesh" ? 0 : seconds;
    score_points(result.orientation, input, row);
  } catch (const Error& error) {
    row.error = error.what();
  }
  return row;
}

}  // namespace g3r::bench
