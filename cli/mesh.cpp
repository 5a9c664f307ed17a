// g3r mesh ORIENTED OUT: points that already have outward normals in, a mesh out.
#include "mesh/findings.h"

#include <g3r/g3r.h>
#include <g3r/io.h>

#include "commands.h"
#include "summary.h"

namespace g3r::cli {

int run_mesh(const Settings& settings, Session& session) {
  const Cloud cloud = session.stage("read", [&] { return read_cloud(settings.input, session.cancellable(settings.read_options)); });
  if (cloud.normals.empty()) {
    throw InvalidInput(escape_text(settings.input) + " has no normals: `g3r orient` makes them, `g3r IN OUT` goes all the way");
  }
  MeshOptions options = settings.mesh_options;
  options.threads = settings.options.threads;
  Dropped dropped;
  Mesh mesh = session.stage("mesh", [&] { return mesh_oriented(cloud.positions, cloud.normals, options, session.monitor(), &dropped); });
  MeshCheck check = check_mesh(mesh);
  check.dropped = dropped;
  session.stage("carry", [&] { carry_attributes(mesh, cloud.positions, cloud.colors, cloud.confidence); });
  session.stage("write", [&] {
    for (const std::string& output : settings.outputs()) write_mesh(output, mesh, session.cancellable(settings.write_options));
  });
  Stats stats;
  stats.points = stats.used = cloud.positions.size();
  stats.method = options.mesher == Mesher::kPoisson ? "poisson" : "field";
  stats.depth = options.depth;
  stats.converged = true;
  stats.warnings = cloud.warnings;
  warn_of_faces(mesh.triangles.size(), options.faces, stats.warnings);
  if (!check.closed) stats.warnings.emplace_back("the mesh is not closed");
  return finish(settings, session, stats, &check);
}

}  // namespace g3r::cli
