#include "sensors.h"

#include "text.h"

namespace g3r::cli {

Options with_sensors(const Settings& settings, const Cloud& cloud) {
  Options options = settings.options;
  if (!settings.sensors_of_file) return options;
  if (cloud.sensor_positions.empty()) {
    throw InvalidInput(escape_text(settings.input) + " does not say where the scanner stood: --sensor X,Y,Z does");
  }
  options.hints.sensors = cloud.sensor_positions;
  options.hints.sensor_of_point = cloud.scan_of_point;
  return options;
}

void mention_sensors(const Cloud& cloud, Stats& stats) {
  if (cloud.sensor_positions.empty() || stats.open_share == 0 || !stats.hints.given.empty()) return;
  stats.warnings.push_back("the file names " + counted(cloud.sensor_positions.size(), "scanner position") +
                           ": with --sensor file the open sheets face the scanner");
}

}  // namespace g3r::cli
