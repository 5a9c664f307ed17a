// From points, or oriented points, to a mesh.
#include "base/number_text.h"
#include "base/stages.h"
#include "base/vector.h"
#include "cpu/parallel.h"
#include "field/oriented_cloud.h"
#include "field/points_with_normals.h"
#include "field/surface_points.h"
#include "field/winding_sampler.h"
#include "mesh/component_support.h"
#include "mesh/constants.h"
#include "mesh/field_mesher.h"
#include "mesh/field_octree.h"
#include "mesh/field_points.h"
#include "mesh/findings.h"
#include "mesh/mesh_finish.h"
#include "mesh/screened_poisson.h"
#include "mesh/self_intersections.h"
#include "mesh/separate_vertices.h"
#include "mesh/simplify.h"
#include "mesh/smooth_spacing.h"
#include "mesh/used_vertices.h"
#include "orient/confidence.h"
#include "orient/describe.h"
#include "orient/memory_plan.h"
#include "orient/settings.h"
#include "orient/start.h"
#include "sum/device_scope.h"

#include <g3r/g3r.h>
#include <g3r/names.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
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

Mesh mesh_with_poisson(const OrientedCloud& oriented, const std::vector<Vec3>& normals, int depth) {
  const int chosen = depth > 0 ? depth : automatic_depth(oriented.spacing, kBoxSide);
  return screened_poisson(oriented.cloud.points(), normals, chosen);
}

void turn(std::vector<Vec3>& vectors) {
  for (Vec3& v : vectors) v = {-v[0], -v[1], -v[2]};
}

// What making a mesh starts with and finds out.
struct MeshRun {
  mesh::Found found;
  MeshMemory memory;
  mesh::Unmet unmet{};            // 0 where options ask for less than all of the surface
  double far_share = 0;           // of the surface, farther than mesh::kFarSpacings from every point
  std::size_t new_crossings = 0;  // pairs of triangles that intersect since there are fewer
  // Of the points that the mesh was made of, input units.
  Vec3 box_centre{0, 0, 0};
  double box_side = 0, spacing = 0, noise = 0;
};

// Whether the octree does not resolve the spacing.
bool is_too_wide(double box_side, double spacing, const MeshOptions& options) {
  return options.mesher == Mesher::kField && options.depth == 0 &&
         box_side > std::ldexp(mesh::kFinestCell, mesh::kMaxOctreeLevel) * spacing;
}

bool asks_for_all(const MeshOptions& options) {
  return options.trim == MeshOptions::Trim::kOff && options.depth == 0 && options.keep_largest == 0 && !options.min_component;
}

// Meshes in normalised units, so that georeferenced coordinates lose nothing, and maps back. What is inside out is meshed as the solid that
// it surrounds, and the triangles are turned.
Mesh make_mesh(OrientedCloud oriented, const MeshOptions& options, const Monitor& monitor, MeshRun& run) {
  mesh::Found& found = run.found;
  for (Vec3& p : found.strays) p = oriented.cloud.frame.to_unit(p);
  // Whatever the order of the input, and however often it has them.
  std::sort(found.strays.begin(), found.strays.end());
  found.strays.erase(std::unique(found.strays.begin(), found.strays.end()), found.strays.end());
  if (!options.keep_all) keep_surface_points(oriented, found.strays, monitor.cancel);
  found.dropped.points = found.strays.size();
  const WindingSampler field(oriented, monitor.cancel);
  const bool inside_out = is_inside_out(oriented, field);
  if (inside_out) turn(oriented.eta);
  const std::vector<Vec3>& points = oriented.cloud.points();
  std::vector<Vec3> directions = directions_of(oriented.eta);
  const Frame& frame = oriented.cloud.frame;
  MeshOptions normalised = options;
  normalised.trim_distance *= frame.scale;
  const std::optional<double> noise = given_noise(options.noise, oriented.cloud, oriented.spacing);
  if (noise) normalised.noise = {Length::Unit::kInput, *noise};
  Mesh mesh;
  if (options.mesher == Mesher::kPoisson) {
    mesh = mesh_with_poisson(oriented, directions, options.depth);
    normalised.min_component = 0;  // spurious components of screened Poisson are part of its result
    mesh::finish_mesh(mesh, {points, directions, mesh::smooth_spacing(points)}, 0, normalised, found, monitor.cancel);
  } else {
    oriented.cloud.set.release_neighbours();  // the mesher has its own, of the points that it moves
    mesh = field_mesh(points, std::move(directions), field, normalised, monitor, &run.memory, &found);
  }
  found.dropped.area /= frame.scale * frame.scale;
  run.box_centre = frame.centre;
  run.box_side = frame.length_to_world(kBoxSide);
  run.spacing = frame.length_to_world(oriented.spacing);
  run.noise = frame.length_to_world(noise.value_or(found.noise));
  if (mesh.triangles.empty()) {
    throw InvalidInput(is_too_wide(run.box_side, run.spacing, options)
                           ? "no surface found: the cloud is more than 800,000 spacings wide; mesh parts that are far apart one by one"
                           : "no surface found: the oriented points do not enclose a volume");
  }
  run.far_share = mesh::far_share(mesh, points, mesh::kFarSpacings);
  if (asks_for_all(options)) {
    run.unmet = mesh::unmet_points(mesh, points, directions_of(oriented.eta), mesh::smooth_spacing(points), found.noise);
  }
  if (options.faces > 0 && mesh.triangles.size() > options.faces) {
    const std::size_t crossings = mesh::self_intersections(mesh, monitor.cancel).size();
    mesh::simplify(mesh, options.faces, monitor.cancel);
    const std::size_t left = mesh::self_intersections(mesh, monitor.cancel).size();
    run.new_crossings = left > crossings ? left - crossings : 0;
  }
  if (inside_out) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  for (Vec3& v : mesh.vertices) {
    for (std::size_t a = 0; a < 3; ++a) v[a] = v[a] / frame.scale + frame.centre[a];
  }
  mesh::separate_vertices(mesh);
  return mesh;
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

// Orientation and mesh come one after the other. What Open3D will take is not known.
std::size_t planned(const Stats& stats, const MeshOptions& chosen) {
  if (chosen.mesher == Mesher::kPoisson) return stats.planned_memory_bytes;
  return std::max(stats.planned_memory_bytes, field_mesh_memory(stats.used, stats.spacing, stats.noise, stats.box_side, chosen.depth));
}

bool is_noisy(const Stats& stats) { return stats.noise > mesh::kNoisy * stats.spacing; }

// Points without surface, or with that of the other side, and surface without points.
void warn_of_missing(const mesh::Unmet& unmet, const mesh::Found& found, Stats& stats) {
  if (unmet.bare > kDoubtful) {
    stats.warnings.push_back(
        percent(unmet.bare) + " of the points have no surface near them: parts whose points are much closer together than is usual" +
        (is_noisy(stats) ? ", or that are thinner than the noise" : "") + ", or points that are no surface; mesh such parts one by one");
  }
  if (unmet.turned > kDoubtful) {
    stats.warnings.push_back(
        percent(unmet.turned) + " of the points are on surface that faces away from their normals: walls or gaps below " +
        (is_noisy(stats) ? "the noise" : "the spacing") + ", normals that face the wrong way, or points that are no surface");
  }
  if (found.pointless_area > kDoubtful) {
    stats.warnings.push_back(percent(found.pointless_area) +
                             " of the surface is of parts that no point is on: normals of one part of the cloud face the other way");
  }
  stats.doubtful = stats.doubtful || std::max({unmet.bare, unmet.turned, found.pointless_area}) > kManyUnsure;
}

void warn_of_trimming(const mesh::Found& found, const MeshOptions& options, Stats& stats) {
  if (options.trim == MeshOptions::Trim::kOff) return;
  const bool by_distance = options.trim == MeshOptions::Trim::kDistance;
  if (!found.trimmed) {
    stats.warnings.push_back("nothing was trimmed: no surface is farther than " +
                             (by_distance ? short_number(options.trim_distance) : short_number(mesh::kFarSpacings) + " spacings") +
                             " from the points");
  }
  if (by_distance && options.trim_distance < mesh::kGap * stats.spacing) {
    stats.warnings.push_back("trimmed at " + short_number(options.trim_distance) +
                             ", which is less than the gaps between the points and leaves holes: " + short_number(mesh::kFarSpacings) +
                             " spacings are " + short_number(mesh::kFarSpacings * stats.spacing));
  }
}

// What is doubtful of a mesh, and what its memory turned out to be. `options`: with the mesher chosen.
void describe_mesh(const MeshCheck& check, const MeshRun& run, const MeshOptions& options, Stats& stats) {
  stats.depth = options.depth;
  stats.planned_memory_bytes = std::max(stats.planned_memory_bytes, run.memory.needed);
  const bool is_trimmed = options.trim != MeshOptions::Trim::kOff;
  if (run.far_share > kDoubtful) {
    stats.warnings.push_back(percent(run.far_share) + " of the surface is farther than " + short_number(mesh::kFarSpacings) +
                             " spacings from any point: the cloud looks open" +
                             (is_noisy(stats) ? ", as do two walls that are no farther apart than its noise" : "") +
                             (is_trimmed ? "" : "; trim the mesh (--open)"));
    stats.doubtful = stats.doubtful || (run.far_share > kManyUnsure && !is_trimmed);
  }
  warn_of_missing(run.unmet, run.found, stats);
  warn_of_trimming(run.found, options, stats);
  warn_of_topology(check, stats);
  warn_of_faces(check.triangles, options.faces, run.new_crossings, stats.warnings);
  if (is_too_wide(stats.box_side, stats.spacing, options)) {
    stats.warnings.emplace_back(
        "the cloud is more than 800,000 spacings wide, so the mesh is coarser than the points: mesh parts that are far apart one by one");
  }
  if ((!check.closed && !is_trimmed) || !check.manifold) {
    stats.warnings.emplace_back(check.closed ? "the mesh is not manifold" : "the mesh is not closed");
  }
}

// What is known before the mesh. `given`: what `oriented` was made of.
Stats describe_oriented(const PointsWithNormals& given, const OrientedCloud& oriented, const MeshOptions& options) {
  const CanonicalCloud& cloud = oriented.cloud;
  Stats stats;
  stats.used = cloud.size();
  stats.dropped_non_finite = given.non_finite;
  stats.outliers = given.far.size();
  stats.merged_duplicates = given.points.size() - oriented.undirected - cloud.size();
  stats.points = given.points.size() + given.non_finite + given.undirected + given.far.size();
  stats.box_centre = cloud.frame.centre;
  stats.box_side = kBoxSide / cloud.frame.scale;
  stats.spacing = cloud.frame.length_to_world(oriented.spacing);
  stats.noise = cloud.frame.length_to_world(given_noise(options.noise, cloud, oriented.spacing).value_or(0));
  stats.method = name_of(options.mesher);
  stats.converged = true;  // nothing had to
  stats.threads = parallel::thread_count(options.threads);
  stats.planned_memory_bytes = planned(stats, options);
  if (given.non_finite > 0) {
    stats.warnings.push_back(std::to_string(given.non_finite) + " points with a non-finite coordinate were left out");
  }
  warn_of_far(given.far.size(), stats);
  if (given.undirected > 0) {
    stats.warnings.push_back(std::to_string(given.undirected) +
                             " points with a normal of (0, 0, 0) or one that is not finite were left out");
  }
  if (oriented.undirected > 0) {
    stats.warnings.push_back(std::to_string(oriented.undirected) +
                             " points at places where normals are opposite and cancel out were left out");
  }
  return stats;
}

}  // namespace

Stats plan(const PointsView& points, const Options& options, const MeshOptions& mesh_options) {
  require_usable(mesh_options);
  const MeshOptions chosen = choose(mesh_options, options);
  Stats stats = plan(points, options);
  stats.depth = chosen.depth;
  stats.planned_memory_bytes = planned(stats, chosen);
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
    require_memory(planned(stats, chosen), options.max_memory, true);
  }
  Reconstruction out;
  const gpu::Scope device(options.device, points.count);  // one for both steps
  out.orientation = orient(points, options, monitor);
  out.orientation.stats.planned_memory_bytes = planned(out.orientation.stats, chosen);
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
