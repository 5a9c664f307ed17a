#include "sensors.h"

#include "base/control_groups.h"

#include <cmath>
#include <cstddef>

#include "text.h"

namespace g3r::cli {
namespace {

// The share of the points, weighed by the cosine under which they are seen, that face away from the scanner where it stood inside: of a
// solid seen from outside a half or less do.
constexpr double kSurrounded = 2.0 / 3;

double share_facing_away(const Cloud& cloud, const std::vector<Vec3>& normals) {
  double towards = 0;
  double away = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::size_t scan = cloud.scan_of_point.empty() ? 0 : cloud.scan_of_point[i];
    if (scan >= cloud.sensor_positions.size()) continue;
    const Vec3& s = cloud.sensor_positions[scan];
    const Vec3& p = cloud.positions[i];
    const Vec3 d{s[0] - p[0], s[1] - p[1], s[2] - p[2]};
    const double distance = std::hypot(d[0], d[1], d[2]);
    const double cosine = (d[0] * normals[i][0] + d[1] * normals[i][1] + d[2] * normals[i][2]) / distance;
    if (!std::isfinite(cosine)) continue;  // at the scanner itself, or not finite
    (cosine > 0 ? towards : away) += std::abs(cosine);
  }
  return towards + away > 0 ? away / (towards + away) : 0;
}

}  // namespace

Options run_options(const Settings& settings, const Cloud& cloud) {
  Options options = settings.options;
  // Of the points that are read already, so that there is some to spare.
  if (options.max_memory == 0) options.max_memory = platform::share_of_free_memory(1);
  if (!settings.sensors_of_file) return options;
  if (cloud.sensor_positions.empty()) {
    throw InvalidInput(escape_text(settings.input) + " does not say where the scanner stood: --sensor X,Y,Z does");
  }
  options.hints.sensors = cloud.sensor_positions;
  options.hints.sensor_of_point = cloud.scan_of_point;
  return options;
}

void mention_sensors(const Cloud& cloud, const std::vector<Vec3>& normals, Stats& stats) {
  if (cloud.sensor_positions.empty() || !stats.hints.given.empty() || stats.hints.viewpoint) return;
  const std::string named = "the file names " + counted(cloud.sensor_positions.size(), "scanner position");
  const double away = share_facing_away(cloud, normals);
  if (stats.open_share > 0) {
    stats.warnings.push_back(named + ": with --sensor file the open surfaces face the scanner");
  } else if (away >= kSurrounded) {
    stats.warnings.push_back(named + ", and " + exact_percent(away) +
                             " of the points face away, as in a room that is seen from inside: with "
                             "--sensor file they face the scanner");
  }
}

}  // namespace g3r::cli
