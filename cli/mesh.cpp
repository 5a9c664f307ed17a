// g3r mesh ORIENTED OUT: points that already have outward normals in, a mesh out.
#include <g3r/g3r.h>
#include <g3r/io.h>

#include "commands.h"
#include "sensors.h"
#include "summary.h"

namespace g3r::cli {

int run_mesh(const Settings& settings, Session& session) {
  const Cloud cloud = session.stage("read", [&] { return read_cloud(settings.input, session.cancellable(settings.read_options)); });
  if (cloud.normals.empty()) {
    throw InvalidInput(escape_text(settings.input) + " has no normals: `g3r orient` makes them, `g3r IN OUT` goes all the way");
  }
  const Options run = run_options(settings, cloud);
  MeshOptions options = settings.mesh_options;
  options.threads = run.threads;
  options.max_memory = run.max_memory;
  MeshReport report;
  Mesh mesh = session.stage("mesh", [&] { return mesh_oriented(cloud.positions, cloud.normals, options, session.monitor(), &report); });
  session.stage("carry",
                [&] { carry_attributes(mesh, cloud.positions, cloud.colors, cloud.confidence, session.monitor(), cloud.normals); });
  session.stage("write", [&] {
    for (const std::string& output : settings.outputs()) write_mesh(output, mesh, session.cancellable(settings.write_options));
  });
  Stats& stats = report.stats;
  stats.warnings.insert(stats.warnings.begin(), cloud.warnings.begin(), cloud.warnings.end());
  return finish(settings, session, stats, &report.check);
}

}  // namespace g3r::cli
