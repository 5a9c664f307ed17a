// g3r sample MESH OUT: points on a mesh, uniform by area, with the normals of their triangles.
#include "mesh/used_vertices.h"

#include <g3r/io.h>
#include <g3r/metrics.h>

#include <cmath>

#include "commands.h"
#include "text.h"

namespace g3r::cli {
namespace {

// Of the surface: vertices that no triangle uses may be anywhere.
double box_diagonal(const Mesh& mesh) {
  const vector::Box box = box_of_used_vertices(mesh);
  return std::hypot(box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]);
}

}  // namespace

int run_sample(const Settings& settings, Session& session) {
  const Mesh mesh = session.stage("read", [&] { return read_mesh(settings.input); });
  const bool percent = settings.noise.unit == Length::Unit::kPercent;
  const double noise = settings.noise.value * (percent ? box_diagonal(mesh) / 100 : 1);
  Samples samples =
      session.stage("sample", [&] { return sample_mesh(mesh, settings.sample_count, settings.seed, noise, session.monitor()); });
  Cloud cloud;
  cloud.positions = std::move(samples.points);
  session.stage("write",
                [&] { write_cloud(settings.output, cloud, &samples.normals, nullptr, session.cancellable(settings.write_options)); });
  for (const std::string& warning : session.write_warnings()) session.console().warn(warning);
  session.console().say(counted(cloud.positions.size(), "point") + " with normals" +
                        (settings.output == "-" ? "" : " in " + escape_text(settings.output)));
  return 0;
}

}  // namespace g3r::cli
