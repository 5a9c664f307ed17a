// From points, or oriented points, to a mesh.
#include "base/stages.h"
#include "base/vector.h"
#include "cpu/parallel.h"
#include "describe_mesh.h"
#include "field/oriented_cloud.h"
#include "field/points_with_normals.h"
#include "mesh/screened_poisson.h"
#include "mesh/used_vertices.h"
#include "mesh_run.h"
#include "orient/memory_plan.h"
#include "orient/start.h"
#include "sum/device_scope.h"

#include <g3r/g3r.h>
#include <g3r/names.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace g3r {
namespace {

// The extent from which squares of areas, also of triangles with sides of a ten-millionth, have all their digits.
constexpr double kLeastExtent = 1e-70;

// Throws before the work what the mesh could not be measured with. O(N).
void require_meshable(const PointsView& points) {
  double largest = 0;
  double extent = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < points.count; ++i) {
      const double x = points[i][a];
      if (!std::isfinite(x)) continue;
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (low > high) return;
    largest = std::max({largest, -low, high});
    extent = std::max(extent, high - low);
  }
  if (largest > kLargestCoordinate) throw InvalidInput("coordinates beyond 1e50 cannot be meshed; scale them down");
  if (extent > 0 && extent < kLeastExtent) throw InvalidInput("an extent below 1e-70 cannot be meshed; scale the coordinates up");
}

// Refuses before any work what the mesher would refuse after most of it.
void require_usable(const MeshOptions& options) {
  if (options.depth != 0 && (options.depth < kLeastMeshDepth || options.depth > kMostMeshDepth)) {
    throw InvalidInput("depth must be 0 (automatic) or " + std::to_string(kLeastMeshDepth) + " to " + std::to_string(kMostMeshDepth) +
                       ", not " + std::to_string(options.depth));
  }
  if (options.trim == MeshOptions::Trim::kDistance && !(options.trim_distance > 0 && std::isfinite(options.trim_distance))) {
    throw InvalidInput("the trim distance must be above 0 and finite");
  }
  if (!(options.min_component.value_or(0) >= 0)) throw InvalidInput("min_component must be 0 or more");
}

// The points that the solve left out: they have a place, but no area.
std::vector<Vec3> outliers_of(const PointsView& points, const Orientation& orientation) {
  std::vector<Vec3> outliers;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (orientation.areas[i] == 0 && vector::is_finite(points[i])) outliers.push_back(points[i]);
  }
  return outliers;
}

MeshOptions choose(const MeshOptions& given, const Options& options) {
  MeshOptions chosen = given;
  chosen.noise = options.noise;
  if (chosen.mesher == Mesher::kAuto) {
    const bool poisson = options.preset == Preset::kPaper && screened_poisson_available();
    chosen.mesher = poisson ? Mesher::kPoisson : Mesher::kField;
  }
  if (options.preset == Preset::kPaper && chosen.mesher == Mesher::kPoisson && chosen.depth == 0) chosen.depth = kMostAutomaticDepth;
  return chosen;
}

}  // namespace

Stats plan(const PointsView& points, const Options& options, const MeshOptions& mesh_options) {
  require_usable(mesh_options);
  const MeshOptions chosen = choose(mesh_options, options);
  Stats stats = plan(points, options);
  stats.depth = chosen.depth;
  stats.planned_memory_bytes = planned_with_mesh(stats, chosen);
  return stats;
}

Mesh mesh_oriented(const PointsView& points, const PointsView& normals, const MeshOptions& options, const Monitor& monitor,
                   MeshReport* report) {
  if (points.count != normals.count) {
    throw InvalidInput(std::to_string(points.count) + " points but " + std::to_string(normals.count) + " normals");
  }
  if (options.threads < 0) throw InvalidInput("threads must be 0 (all cores) or positive");
  require_usable(options);
  require_meshable(points);
  MeshOptions chosen = options;
  if (chosen.mesher == Mesher::kAuto) chosen.mesher = Mesher::kField;
  PointsWithNormals given = with_normals(points, normals);
  if (given.points.empty() && given.undirected > 0) {
    throw InvalidInput("there are no normals: all that the points have are (0, 0, 0) or not finite");
  }
  return parallel::with_threads(options.threads, [&] {
    const gpu::Scope device(options.device, given.points.size());
    OrientedCloud oriented = oriented_cloud(given.points, given.normals);
    Stats stats = describe_oriented(given, oriented, chosen);
    require_memory(stats.planned_memory_bytes, options.max_memory, true);
    MeshRun run{{std::move(given.far), {}}, {options.max_memory, 0}};
    given = {};  // its memory is wanted
    Mesh mesh = make_mesh(std::move(oriented), chosen, monitor, run);
    if (report == nullptr) return mesh;
    report->check = check_mesh(mesh);
    report->check.dropped = run.found.dropped;
    stats.box_centre = run.box_centre;
    stats.box_side = run.box_side;
    stats.spacing = run.spacing;
    stats.noise = run.noise;
    describe_mesh(report->check, run, chosen, stats);
    device.describe(stats);
    report->stats = std::move(stats);
    return mesh;
  });
}

Reconstruction reconstruct(const PointsView& points, const Options& options, const MeshOptions& mesh_options, const Monitor& monitor) {
  if (mesh_options.mesher == Mesher::kPoisson) require_screened_poisson();
  require_usable(mesh_options);
  require_meshable(points);
  const MeshOptions chosen = choose(mesh_options, options);
  if (options.max_memory > 0) {
    const Stats stats = plan_of(points, options, {{}, monitor.cancel});  // whose progress is not that of the run
    require_memory(planned_with_mesh(stats, chosen), options.max_memory, true);
  }
  Reconstruction out;
  const gpu::Scope device(options.device, points.count);  // one for both steps
  out.orientation = orient(points, options, monitor);
  out.orientation.stats.planned_memory_bytes = planned_with_mesh(out.orientation.stats, chosen);
  Stages stages(monitor);
  stages.time_device([&device] { return device.seconds(); });
  stages.begin("mesh");
  MeshRun run{{outliers_of(points, out.orientation), {}}, {options.max_memory, 0}};
  parallel::with_threads(options.threads, [&] {
    const gpu::Scope same_device(options.device, points.count);
    OrientedCloud oriented = oriented_cloud(points, out.orientation.normals, out.orientation.areas);
    out.mesh = make_mesh(std::move(oriented), chosen, monitor, run);
    out.check = check_mesh(out.mesh);
    out.check.dropped = run.found.dropped;
    carry_attributes(out.mesh, points, {}, out.orientation.confidence, {{}, monitor.cancel}, out.orientation.normals);
  });
  device.describe(out.orientation.stats);
  describe_mesh(out.check, run, chosen, out.orientation.stats);
  stages.finish(out.orientation.stats);
  return out;
}

}  // namespace g3r
