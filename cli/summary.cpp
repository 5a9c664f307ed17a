#include "summary.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "exit_code.h"
#include "files.h"
#include "text.h"

namespace g3r::cli {
namespace {

// Stages shorter than this share of the whole are not worth a place in the summary.
constexpr double kSmallestPart = 0.05;

std::string line(const char* label, const std::string& text) {
  std::string padded = std::string("  ") + label;
  padded.resize(11, ' ');
  return padded + text;
}

std::string input_text(const Settings& settings, const Stats& stats) {
  std::string text = settings.input == "-" ? "standard input" : escape_text(settings.input);
  text += ": " + counted(stats.points, "point");
  if (stats.merged_duplicates > 0) text += ", " + counted(stats.merged_duplicates, "duplicate") + " merged";
  if (stats.dropped_non_finite > 0) text += ", " + with_commas(stats.dropped_non_finite) + " not finite";
  if (stats.outliers > 0) text += ", " + counted(stats.outliers, "outlier") + " left out";
  return text;
}

std::string scale_text(const Stats& stats) {
  std::string text = "spacing " + short_number(stats.spacing) + " in a box of side " + short_number(stats.box_side);
  if (stats.epsilon > 0 && stats.spacing > 0) {
    text += ", epsilon " + short_number(stats.epsilon) + " (" + short_number(stats.epsilon / stats.spacing, 2) + " spacings)";
  }
  return text;
}

std::string solve_text(const Stats& stats) {
  if (stats.iterations.empty()) return stats.solver;
  const char* end = !stats.converged        ? "not converged"
                    : stats.open_share == 1 ? "which open surfaces do not depend on"
                    : stats.tolerance > 0   ? "converged"
                                            : "as scheduled";
  return counted(stats.iterations.size(), "iteration") + ", residual " + short_number(stats.iterations.back().residual, 2) + ", " + end;
}

std::string mesh_text(const MeshCheck& check) {
  std::string text = counted(check.triangles, "triangle") + ", " + (check.closed ? "closed" : "not closed") + ", " +
                     (check.manifold ? "manifold" : "not manifold") + ", " + counted(check.components, "component");
  if (check.closed && check.manifold) text += ", genus " + std::to_string(check.genus);
  if (check.dropped.components > 0) text += "; " + counted(check.dropped.components, "part") + " without support left out";
  return text;
}

std::string time_text(const Stats& stats) {
  std::map<std::string, double> seconds;
  for (const auto& [stage, value] : stats.seconds) seconds[stage] += value;
  std::string text = duration(seconds["total"]);
  std::string parts;
  for (const char* stage : {"read", "build", "solve", "refine", "mesh", "write"}) {
    const double value = seconds[stage];
    if (value >= std::max(kSmallestPart * seconds["total"], 0.01))
      parts += (parts.empty() ? "" : ", ") + std::string(stage) + " " + short_number(value, 2);
  }
  if (!parts.empty()) text += " (" + parts + ")";
  if (!stats.device.empty() && stats.device != "cpu") text += " on " + escape_text(stats.device) + " and";
  if (stats.threads > 0)
    text += (stats.device.empty() || stats.device == "cpu" ? " on " : " ") + counted(static_cast<std::size_t>(stats.threads), "thread");
  return text + ", at most " + bytes(stats.peak_memory_bytes) + " of memory";
}

void show_details(Console& console, const Stats& stats) {
  if (!stats.method.empty()) {
    console.detail(line("method", escape_text(stats.method) + ", harmonics " + escape_text(stats.harmonics) + ", " + stats.sums + " sums"));
  }
  for (std::size_t i = 0; i < stats.iterations.size(); ++i) {
    const Iteration& step = stats.iterations[i];
    console.detail(line("", std::to_string(i + 1) + " " + step.kind + "  residual " + short_number(step.residual, 3)));
  }
  if (stats.condition_number > 0) console.say(line("condition", short_number(stats.condition_number, 3)));
}

// A camera at the origin of its coordinates is found within rounding.
std::string place_text(const Vec3& place) {
  std::string text;
  const double size = std::max({std::abs(place[0]), std::abs(place[1]), std::abs(place[2]), 1.0});
  for (const double x : place) text += (text.empty() ? "" : ", ") + short_number(std::abs(x) < 1e-9 * size ? 0 : x, 4);
  return text;
}

bool is_given(const HintStats& hints, const std::string& name) {
  return std::find(hints.given.begin(), hints.given.end(), name) != hints.given.end();
}

void show_summary(const Settings& settings, Console& console, const Stats& stats, const MeshCheck* mesh) {
  console.say(line("input", input_text(settings, stats)));
  if (stats.spacing > 0) console.say(line("scale", scale_text(stats)));
  show_details(console, stats);
  if (!stats.solver.empty()) {
    console.say(line("solve", solve_text(stats)));
    console.say(line("normals", "mean confidence " + short_number(stats.confidence_mean, 2) + ", " +
                                    exact_percent(stats.confidence_below_half) + " of the points below 0.5"));
    if (stats.hints.viewpoint && !is_given(stats.hints, "sensor")) {
      console.say(line("camera", "at " + place_text(*stats.hints.viewpoint) + ", as the rows of pixels show"));
    }
  }
  if (mesh != nullptr) console.say(line("mesh", mesh_text(*mesh)));
  console.say(line("time", time_text(stats)));
  std::vector<std::string> written = settings.outputs();
  if (!settings.oriented.empty()) written.push_back(settings.oriented);
  for (const std::string& output : written) {
    if (output != "-") console.say(line("wrote", escape_text(output)));
  }
}

// What makes a result doubtful, "" if nothing does.
std::string doubts_of(const Stats& stats, bool is_open) {
  std::string text;
  const auto add = [&](bool is_so, const char* what) { text += is_so ? (text.empty() ? "" : ", ") + std::string(what) : ""; };
  add(!stats.converged, "the solver did not reach its tolerance");
  add(!stats.consistent, "the sides of many points are unsure or a choice");
  add(stats.doubtful, "a warning says that this is most likely not what was measured");
  add(is_open, "the mesh is not closed");
  return text;
}

}  // namespace

int finish(const Settings& settings, Session& session, Stats stats, const MeshCheck* mesh) {
  session.complete(stats);
  const bool is_open = mesh != nullptr && !mesh->closed && settings.mesh_options.trim == MeshOptions::Trim::kOff;
  Console& console = session.console();
  for (const std::string& warning : stats.warnings) console.warn(warning);
  show_summary(settings, console, stats, mesh);
  if (!settings.report.empty()) write_text(settings.report, report_json(stats, mesh));
  const std::string doubts = doubts_of(stats, is_open);
  if (!settings.strict || doubts.empty()) return kOk;
  console.fail("--strict: " + doubts + "; the results are written all the same");
  return kBadData;
}

}  // namespace g3r::cli
