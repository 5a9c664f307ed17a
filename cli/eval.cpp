// g3r eval RESULT --truth GT: scores as JSON on standard output. Meshes are compared as surfaces, clouds point by point.
#include <g3r/io.h>
#include <g3r/metrics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.h"
#include "files.h"
#include "text.h"

namespace g3r::cli {
namespace {

using Json = nlohmann::ordered_json;

// Points that are farther apart than this share of the box, and what float files round, are other points.
constexpr double kSamePointShare = 1e-5;

Cloud oriented_cloud(const std::string& path, const Input& input, const ReadOptions& options, Console& console) {
  Cloud cloud = input.cloud(options);
  for (const std::string& warning : cloud.warnings) console.warn(escape_text(path) + ": " + warning);
  if (cloud.normals.empty()) throw InvalidInput(escape_text(path) + " has neither faces nor normals");
  return cloud;
}

void warn_if_moved(const Cloud& result, const Cloud& truth, Console& console) {
  double side = 0, largest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& p : truth.positions) {
      if (!std::isfinite(p[a])) continue;
      low = std::min(low, p[a]);
      high = std::max(high, p[a]);
    }
    if (low > high) continue;
    side = std::max(side, high - low);
    largest = std::max({largest, -low, high});
  }
  const double allowed = kSamePointShare * side + 2 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest;
  for (std::size_t i = 0; i < truth.positions.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::abs(result.positions[i][a] - truth.positions[i][a]) > allowed) {
        console.warn("point " + std::to_string(i) + " is not where the truth has it: are these the same points in the same order?");
        return;
      }
    }
  }
}

Json score_points(const Settings& settings, const Input& of_result, const Input& of_truth, Session& session) {
  const ReadOptions options = session.cancellable(settings.read_options);
  const Cloud result = oriented_cloud(settings.input, of_result, options, session.console());
  const Cloud truth = oriented_cloud(settings.truth, of_truth, options, session.console());
  if (result.positions.size() != truth.positions.size()) {
    throw InvalidInput("the result has " + counted(result.positions.size(), "point") + ", the truth " +
                       counted(truth.positions.size(), "point"));
  }
  warn_if_moved(result, truth, session.console());
  const NormalScore score = score_normals(result.normals, truth.normals);
  return {{"kind", "points"},   {"points", score.points}, {"ae_p", score.ae},
          {"pco", score.pco},   {"rmse", score.rmse},     {"rmse_unoriented", score.rmse_unoriented},
          {"pgp5", score.pgp5}, {"pgp10", score.pgp10}};
}

Json score_meshes(const Settings& settings, const Mesh& result, const Mesh& truth, const Monitor& monitor) {
  const MeshScore score = score_mesh(result, truth, {settings.sample_count, settings.seed, settings.distances}, monitor);
  Json f_scores = Json::array();
  for (const FScore& f : score.f_scores) {
    f_scores.push_back({{"distance", f.distance}, {"precision", f.precision}, {"recall", f.recall}, {"f", f.f}});
  }
  return {{"kind", "mesh"},        {"samples", settings.sample_count},
          {"cd", score.chamfer},   {"ae_m", score.ae},
          {"hd", score.hausdorff}, {"normal_consistency", score.normal_consistency},
          {"f_scores", f_scores}};
}

}  // namespace

int run_eval(const Settings& settings, Session& session) {
  const Json scores = session.stage("evaluate", [&] {
    const Input of_result(settings.input), of_truth(settings.truth);
    const MeshIfAny result = of_result.mesh(), truth = of_truth.mesh();
    if (result.mesh && truth.mesh) return score_meshes(settings, *result.mesh, *truth.mesh, session.monitor());
    const bool is_mixed = result.mesh || truth.mesh;
    for (const std::string& refused : {result.refused, truth.refused}) {
      if (refused.empty()) continue;
      if (is_mixed) throw InvalidInput(refused);
      session.console().warn("compared as points: " + refused);
    }
    if (!is_mixed) return score_points(settings, of_result, of_truth, session);
    const std::string& mesh = result.mesh ? settings.input : settings.truth;
    const std::string& points = result.mesh ? settings.truth : settings.input;
    throw InvalidInput(
        escape_text(mesh) + " is a mesh, and no faces were read from " + escape_text(points) +
        ": meshes are read from PLY, OBJ, OFF, STL and glTF; to score normals, `g3r sample` makes points with true normals from "
        "the mesh");
  });
  session.console().clear_bar();
  write_text("-", scores.dump(2) + "\n");
  return 0;
}

}  // namespace g3r::cli
