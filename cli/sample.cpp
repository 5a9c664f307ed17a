// g3r sample MESH OUT: points on a mesh, uniform by area, with the normals of their triangles.
#include <g3r/io.h>
#include <g3r/metrics.h>

#include <algorithm>
#include <cmath>

#include "commands.h"
#include "text.h"

namespace g3r::cli {
namespace {

double box_diagonal(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& p : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

}  // namespace

int run_sample(const Settings& settings, Session& session) {
  const Mesh mesh = session.stage("read", [&] { return read_mesh(settings.input); });
  const bool percent = settings.noise.unit == Length::Unit::kPercent;
  const double noise = settings.noise.value * (percent ? box_diagonal(mesh.vertices) / 100 : 1);
  Samples samples = session.stage("sample", [&] { return sample_mesh(mesh, settings.sample_count, settings.seed, noise); });
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
