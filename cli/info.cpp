// g3r info FILE: what is in a file, and what g3r would do with it. Text on standard output, or the plan as JSON with --report -.
#include "base/control_groups.h"
#include "tiles/plan.h"

#include <g3r/g3r.h>
#include <g3r/io.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "files.h"
#include "text.h"

namespace g3r::cli {
namespace {

constexpr int kCoordinateDigits = 10;  // With so many digits coordinates of the whole Earth in metres show millimetres.

std::string line(const char* label, const std::string& text) {
  std::string padded = std::string("  ") + label;
  padded.resize(13, ' ');
  return padded + text + "\n";
}

std::string bounds_text(const std::vector<Vec3>& points) {
  std::string text;
  for (std::size_t a = 0; a < 3; ++a) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3& p : points) {
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
      low = std::min(low, p[a]);
      high = std::max(high, p[a]);
    }
    if (low > high) return "no finite point";
    text += (a == 0 ? "" : ", ") + std::string(1, "xyz"[a]) + " " + short_number(low, kCoordinateDigits) + " to " +
            short_number(high, kCoordinateDigits);
  }
  return text;
}

std::string scanner_text(const std::vector<Vec3>& positions) {
  if (positions.empty()) return "";
  if (positions.size() > 1) return line("scanner", std::to_string(positions.size()) + " positions in the file");
  std::string text;
  for (std::size_t a = 0; a < 3; ++a) text += (a == 0 ? "at " : ", ") + short_number(positions[0][a], kCoordinateDigits);
  return line("scanner", text + ", as the file says");
}

std::string file_text(const Settings& settings, const Cloud& cloud) {
  std::string text = (settings.input == "-" ? "standard input" : escape_text(settings.input)) + "\n";
  const char* precision = cloud.scalar == Scalar::kFloat64 ? "double" : "single";
  text += line("format", escape_text(cloud.format) + ", coordinates in " + precision + " precision");
  text += line("points", with_commas(cloud.positions.size()));
  std::string names;
  for (const std::string& name : cloud.property_names) names.append(names.empty() ? "" : " ").append(escape_text(name));
  if (!names.empty()) text += line("properties", names);
  text += line("normals", cloud.normals.empty() ? "none" : "in the file");
  text += line("bounds", bounds_text(cloud.positions));
  return text + scanner_text(cloud.sensor_positions);
}

MeshCheck full_check(const Mesh& mesh) {
  MeshCheck check = check_mesh(mesh);
  check.self_intersections = count_self_intersections(mesh);
  return check;
}

std::string mesh_text(const MeshCheck& check) {
  std::string text = counted(check.triangles, "triangle") + ", " + (check.closed ? "closed" : "not closed") + ", " +
                     (check.manifold ? "manifold" : "not manifold") + ", " + counted(check.components, "component");
  if (check.closed && check.manifold) text += ", genus " + std::to_string(check.genus) + ", volume " + short_number(check.volume);
  text = line("mesh", text + ", area " + short_number(check.area));
  text += line("crossings", *check.self_intersections == 0 ? "no triangles intersect"
                                                           : counted(*check.self_intersections, "pair") + " of triangles intersect");
  return text +
         line("angles", "smallest " + short_number(check.min_angle) + " degrees, typical smallest " + short_number(check.median_min_angle) +
                            ", longest side over height at most " + short_number(check.max_aspect));
}

std::string in_spacings(double length, double spacing) {
  return short_number(length) + (spacing > 0 ? " (" + short_number(length / spacing, 2) + " spacings)" : "");
}

std::string plan_text(const Stats& stats) {
  std::string text;
  if (stats.dropped_non_finite > 0) text += line("not finite", with_commas(stats.dropped_non_finite) + " would be left out");
  if (stats.outliers > 0) text += line("outliers", with_commas(stats.outliers) + " would be left out");
  if (stats.merged_duplicates > 0) text += line("duplicates", with_commas(stats.merged_duplicates) + " would be merged");
  text += line("spacing", short_number(stats.spacing));
  if (stats.noise > 0) text += line("noise", in_spacings(stats.noise, stats.spacing));
  text += line("epsilon", in_spacings(stats.epsilon, stats.spacing));
  if (stats.depth > 0) text += line("depth", std::to_string(stats.depth));
  text += line("method", escape_text(stats.method) + ", " + stats.solver + ", harmonics " + escape_text(stats.harmonics));
  const std::vector<std::string> devices = device_lines();
  for (const std::string& device : devices) text += line(&device == &devices.front() ? "devices" : "", device);
  return text +
         line("memory", "about " + bytes(stats.planned_memory_bytes) + " to orient and mesh, more if walls are thinner than the spacing");
}

struct Free {
  std::size_t all = 0;  ///< bytes, 0 where the system does not say
  std::size_t limit = 0;
};
Free free_memory() { return {platform::share_of_free_memory(1), tiles::default_limit()}; }

// `given`: --max-memory, 0 for none.
void warn_of_memory(std::size_t given, const Free& free, Stats& stats) {
  const std::size_t needed = stats.planned_memory_bytes;
  const std::size_t limit = given > 0 ? given : free.limit;
  if (limit == 0 || needed <= limit) return;
  const bool refuses = given > 0 || needed > free.all;
  stats.warnings.push_back("more than the " + bytes(limit) + (given > 0 ? " of --max-memory" : ", three quarters of what is free") +
                           ": g3r works in tiles where it can (docs/tiles.md), and " + (refuses ? "refuses" : "in one piece") +
                           " where it cannot");
}

}  // namespace

int run_info(const Settings& settings, Session& session) {
  const Free free = free_memory();  // as for g3r, before the points are read
  const std::pair<Cloud, MeshIfAny> contents = session.stage("read", [&] {
    const Input input(settings.input);
    return std::pair{input.cloud(session.cancellable(settings.read_options)), input.mesh()};
  });
  const Cloud& cloud = contents.first;
  const std::optional<Mesh>& mesh = contents.second.mesh;
  std::string text = file_text(settings, cloud);
  MeshCheck check;
  if (mesh) {
    check = session.stage("check", [&] { return full_check(*mesh); });
    text += mesh_text(check);
  }
  Stats stats;
  try {
    stats = session.stage("plan", [&] { return plan(cloud.positions, settings.options, settings.mesh_options); });
    text += plan_text(stats);
    warn_of_memory(settings.options.max_memory, free, stats);
  } catch (const InvalidInput& error) {
    stats.points = cloud.positions.size();
    stats.warnings.emplace_back(error.what());
  }
  stats.warnings.insert(stats.warnings.begin(), cloud.warnings.begin(), cloud.warnings.end());
  if (!contents.second.refused.empty()) stats.warnings.push_back("no mesh: " + contents.second.refused);
  session.complete(stats);
  for (const std::string& warning : stats.warnings) session.console().warn(warning);
  session.console().clear_bar();
  if (settings.report != "-") write_text("-", text);
  if (!settings.report.empty()) write_text(settings.report, report_json(stats, mesh ? &check : nullptr));
  return 0;
}

}  // namespace g3r::cli
