// Stats and MeshCheck as JSON, schema version 1. Every field is described in docs/report.md; a field is never left out, a value
// that does not apply or is not a finite number is null. Removing or renaming a field, or changing its meaning, raises the version.
#include <g3r/g3r.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace g3r {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchemaVersion = 1;
constexpr int kIndent = 2;
constexpr std::array kStages = {"read", "build", "solve", "refine", "mesh", "write", "total"};

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json place_json(const Vec3& p) { return {number(p[0]), number(p[1]), number(p[2])}; }

/// The documented stages first, 0 for those that were not run; then whatever else was timed. Stages named twice add up.
Json seconds_json(const Stats& stats) {
  Json seconds;
  for (const char* stage : kStages) seconds[stage] = 0.0;
  double sum = 0;
  bool has_total = false;
  for (const auto& [stage, value] : stats.seconds) {
    seconds[stage] = seconds.value(stage, 0.0) + value;
    if (stage == "total") {
      has_total = true;
    } else {
      sum += value;
    }
  }
  if (!has_total) seconds["total"] = sum;
  return seconds;
}

Json iterations_json(const Stats& stats) {
  Json iterations = Json::array();
  for (const Iteration& step : stats.iterations) iterations.push_back({{"kind", step.kind}, {"residual", number(step.residual)}});
  return iterations;
}

Json mesh_json(const MeshCheck& check) {
  const bool has_genus = check.closed && check.manifold;
  return {{"vertices", check.vertices},
          {"faces", check.triangles},
          {"components", check.components},
          {"closed", check.closed},
          {"manifold", check.manifold},
          {"boundary_edges", check.boundary_edges},
          {"nonmanifold_edges", check.nonmanifold_edges},
          {"nonmanifold_vertices", check.nonmanifold_vertices},
          {"genus", has_genus ? Json(check.genus) : Json(nullptr)},
          {"volume", number(check.volume)},
          {"area", number(check.area)},
          {"dropped", {{"points", check.dropped.points}, {"components", check.dropped.components}, {"area", number(check.dropped.area)}}},
          {"self_intersections", check.self_intersections ? Json(*check.self_intersections) : Json(nullptr)},
          {"min_angle", number(check.min_angle)},
          {"median_min_angle", number(check.median_min_angle)},
          {"max_aspect", number(check.max_aspect)}};
}

}  // namespace

std::string report_json(const Stats& stats, const MeshCheck* mesh) {
  Json report;
  report["schema"] = "g3r.report";
  report["schema_version"] = kSchemaVersion;
  report["g3r_version"] = std::string(version());
  report["input"] = {{"points", stats.points},
                     {"used", stats.used},
                     {"dropped_non_finite", stats.dropped_non_finite},
                     {"outliers", stats.outliers},
                     {"merged_duplicates", stats.merged_duplicates}};
  report["scales"] = {{"box_centre", place_json(stats.box_centre)}, {"box_side", number(stats.box_side)},
                      {"spacing", number(stats.spacing)},           {"noise", number(stats.noise)},
                      {"epsilon", number(stats.epsilon)},           {"depth", stats.depth}};
  report["method"] = {{"name", stats.method},
                      {"preset", stats.preset},
                      {"solver", stats.solver},
                      {"harmonics", stats.harmonics},
                      {"sums", stats.sums},
                      {"accuracy", number(stats.accuracy)},
                      {"tolerance", number(stats.tolerance)},
                      {"condition_number", stats.condition_number > 0 ? number(stats.condition_number) : Json(nullptr)}};
  report["iterations"] = iterations_json(stats);
  report["converged"] = stats.converged;
  report["consistent"] = stats.consistent;
  report["doubtful"] = stats.doubtful;
  report["open_share"] = number(stats.open_share);
  report["undecided_share"] = number(stats.undecided_share);
  report["hints"] = {{"given", stats.hints.given},
                     {"settled_share", number(stats.hints.settled_share)},
                     {"turned_share", number(stats.hints.turned_share)},
                     {"agreement", number(stats.hints.agreement)},
                     {"contradicted_share", number(stats.hints.contradicted_share)},
                     {"hidden_share", number(stats.hints.hidden_share)},
                     {"viewpoint", stats.hints.viewpoint ? place_json(*stats.hints.viewpoint) : Json(nullptr)}};
  report["seconds"] = seconds_json(stats);
  report["planned_memory_bytes"] = stats.planned_memory_bytes;
  report["peak_memory_bytes"] = stats.peak_memory_bytes;
  report["threads"] = stats.threads;
  report["device"] = {{"name", stats.device}, {"driver", stats.driver}, {"seconds", Json::object()}};
  for (const auto& [stage, seconds] : stats.device_seconds) report["device"]["seconds"][stage] = seconds;
  report["confidence"] = {{"mean", number(stats.confidence_mean)}, {"below_half", number(stats.confidence_below_half)}};
  report["mesh"] = mesh != nullptr ? mesh_json(*mesh) : Json(nullptr);
  report["warnings"] = stats.warnings;
  // Warnings may quote bytes of a file: whatever is not UTF-8 is replaced rather than refused.
  return report.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace g3r
