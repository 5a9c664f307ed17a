// g3r IN [OUT]: an unoriented cloud in, a watertight mesh out.
#include <g3r/g3r.h>
#include <g3r/io.h>

#include <vector>

#include "commands.h"
#include "files.h"
#include "sensors.h"
#include "summary.h"

namespace g3r::cli {

int run_reconstruct(const Settings& settings, Session& session) {
  if (const std::optional<int> code = reconstruct_in_tiles(settings, session)) return *code;
  Cloud cloud = session.stage("read", [&] { return read_cloud(settings.input, session.cancellable(settings.read_options)); });
  check_points(cloud.positions, {settings.oriented});
  std::vector<Vec3>().swap(cloud.normals);  // of no use here, and the new ones take as much
  Reconstruction result = in_core(settings, true, cloud.positions.size(), [&] {
    return reconstruct(cloud.positions, run_options(settings, cloud), settings.mesh_options, session.monitor());
  });
  if (!cloud.colors.empty()) {
    session.stage("carry", [&] {
      carry_attributes(result.mesh, cloud.positions, cloud.colors, result.orientation.confidence, session.monitor(),
                       result.orientation.normals);
    });
  }
  session.stage("write", [&] {
    const WriteOptions options = session.cancellable(settings.write_options);
    for (const std::string& output : settings.outputs()) write_mesh(output, result.mesh, options);
    if (!settings.oriented.empty()) {
      write_cloud(settings.oriented, cloud, &result.orientation.normals, &result.orientation.confidence, options);
    }
  });
  Stats& stats = result.orientation.stats;
  stats.warnings.insert(stats.warnings.begin(), cloud.warnings.begin(), cloud.warnings.end());
  mention_sensors(cloud, result.orientation.normals, stats);
  return finish(settings, session, stats, &result.check);
}

}  // namespace g3r::cli
