// g3r orient IN OUT: the same points in the same order with all their properties, plus unit normals and confidence.
#include <g3r/g3r.h>
#include <g3r/io.h>

#include <vector>

#include "commands.h"
#include "files.h"
#include "sensors.h"
#include "summary.h"

namespace g3r::cli {

int run_orient(const Settings& settings, Session& session) {
  if (const std::optional<int> code = orient_in_tiles(settings, session)) return *code;
  Cloud cloud = session.stage("read", [&] { return read_cloud(settings.input, session.cancellable(settings.read_options)); });
  check_points(cloud.positions, settings.outputs());
  std::vector<Vec3>().swap(cloud.normals);  // of no use here, and the new ones take as much
  Orientation result = in_core(settings, false, cloud.positions.size(),
                               [&] { return orient(cloud.positions, run_options(settings, cloud), session.monitor()); });
  session.stage("write", [&] {
    for (const std::string& output : settings.outputs()) {
      write_cloud(output, cloud, &result.normals, &result.confidence, session.cancellable(settings.write_options));
    }
  });
  Stats& stats = result.stats;
  stats.warnings.insert(stats.warnings.begin(), cloud.warnings.begin(), cloud.warnings.end());
  mention_sensors(cloud, result.normals, stats);
  return finish(settings, session, stats, nullptr);
}

}  // namespace g3r::cli
