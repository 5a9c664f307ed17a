// From points, or oriented points, to a mesh.
#include "base/median.h"
#include "base/number_text.h"
#include "base/stages.h"
#include "base/vector.h"
#include "cpu/parallel.h"
#include "field/oriented_cloud.h"
#include "field/winding_sampler.h"
#include "mesh/constants.h"
#include "mesh/field_mesher.h"
#include "mesh/field_octree.h"
#include "mesh/field_points.h"
#include "mesh/findings.h"
#include "mesh/held_points.h"
#include "mesh/mesh_finish.h"
#include "mesh/point_parts.h"
#include "mesh/regained_points.h"
#include "mesh/screened_poisson.h"
#include "mesh/separate_vertices.h"
#include "mesh/smooth_spacing.h"
#include "orient/confidence.h"
#include "orient/memory_plan.h"
#include "orient/settings.h"
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

// The depth of screened Poisson in the paper preset, which is that of the comparisons in docs/evidence/meshes.md.
constexpr int kPaperDepth = 10;
// Limits of double: the bounds of coordinates and extents within which areas, volumes and their products are finite and greater than 0.
constexpr double kLargestCoordinate = 1e50;
constexpr double kLeastExtent = 1e-140;

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
  if (extent > 0 && extent < kLeastExtent) throw InvalidInput("an extent below 1e-140 cannot be meshed; scale the coordinates up");
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

std::vector<Vec3> directions_of(const std::vector<Vec3>& eta) {
  std::vector<Vec3> directions(eta.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    directions[i] = eta[i] == Vec3{0, 0, 0} ? Vec3{0, 0, 1} : vector::normalised(eta[i]);
  }
  return directions;
}

// Leaves out the points that are not held. The numbers of the others do not lead to the input any more.
void leave_out(OrientedCloud& oriented, const std::vector<std::uint8_t>& held, std::vector<Vec3>& strays) {
  if (std::find(held.begin(), held.end(), std::uint8_t{0}) == held.end()) return;
  CanonicalCloud& cloud = oriented.cloud;
  std::vector<Vec3> points;
  points.reserve(held.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] == 0) {
      strays.push_back(cloud.points()[i]);
      continue;
    }
    oriented.eta[points.size()] = oriented.eta[i];
    points.push_back(cloud.points()[i]);
  }
  oriented.eta.resize(points.size());
  cloud.set = PointSet(std::move(points));
}

// Takes points back that the surface goes through. Areas follow the spacing.
void regain_points(OrientedCloud& oriented, std::vector<Vec3>& strays, const std::atomic<bool>* cancel) {
  CanonicalCloud& cloud = oriented.cloud;
  std::sort(strays.begin(), strays.end());  // whatever the order of the input
  const std::vector<Vec3> normals = mesh::normals_of_regained(cloud.points(), directions_of(oriented.eta), strays, cancel);
  std::vector<Vec3> points = cloud.points(), left;
  std::vector<double> density;  // area over squared spacing
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& eta = oriented.eta[i];
    const double h = cloud.set.smoothed_spacing()[i];
    density.push_back(std::sqrt(vector::dot(eta, eta)) / (h * h));
  }
  const double usual = median(density);
  std::vector<Vec3> directions = directions_of(oriented.eta);
  for (std::size_t k = 0; k < strays.size(); ++k) {
    if (normals[k] == Vec3{0, 0, 0}) {
      left.push_back(strays[k]);
      continue;
    }
    points.push_back(strays[k]);
    directions.push_back(normals[k]);
    density.push_back(usual);
  }
  if (left.size() == strays.size()) return;
  strays = std::move(left);
  const std::vector<std::uint32_t> order = morton_order(points);
  std::vector<Vec3> sorted, sorted_directions;
  std::vector<double> sorted_density;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::uint32_t i = order[k];
    if (!sorted.empty() && sorted.back() == points[i]) continue;  // the input had it more than once
    sorted.push_back(points[i]);
    sorted_directions.push_back(directions[i]);
    sorted_density.push_back(density[i]);
  }
  cloud.set = PointSet(std::move(sorted));
  oriented.eta.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double h = cloud.set.smoothed_spacing()[i];
    oriented.eta[i] = vector::scale(sorted_directions[i], sorted_density[i] * h * h);
  }
  oriented.spacing = cloud.set.spacing();
}

void turn(std::vector<Vec3>& vectors) {
  for (Vec3& v : vectors) v = {-v[0], -v[1], -v[2]};
}

// Meshes in normalised units, so that georeferenced coordinates lose nothing, and maps back. What is inside out is meshed as the solid that
// it surrounds, and the triangles are turned.
// `far_share` (may be null): share of the surface farther than mesh::kFarSpacings from every point.
Mesh make_mesh(OrientedCloud oriented, const MeshOptions& options, const Monitor& monitor, mesh::LeftOut& left_out,
               MeshMemory* memory = nullptr, double* far_share = nullptr) {
  for (Vec3& p : left_out.strays) p = oriented.cloud.frame.to_unit(p);
  if (!options.keep_all) {
    std::vector<Vec3> doubtful;
    leave_out(oriented, mesh::held_points(oriented.cloud.points(), directions_of(oriented.eta), monitor.cancel), doubtful);
    regain_points(oriented, left_out.strays, monitor.cancel);
    left_out.strays.insert(left_out.strays.end(), doubtful.begin(), doubtful.end());
    leave_out(oriented, mesh::points_of_parts(oriented.cloud.set, left_out.strays), left_out.strays);
  }
  left_out.dropped.points = left_out.strays.size();
  const WindingSampler field(oriented, monitor.cancel);
  const bool inside_out = is_inside_out(oriented, field);
  if (inside_out) turn(oriented.eta);
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
    const std::vector<Vec3>& points = oriented.cloud.points();
    mesh::finish_mesh(mesh, {points, directions, mesh::smooth_spacing(points)}, 0, normalised, left_out, monitor.cancel);
  } else {
    oriented.cloud.set.release_neighbours();  // the mesher has its own, of the points that it moves
    mesh = field_mesh(oriented.cloud.points(), std::move(directions), field, normalised, monitor, memory, &left_out);
  }
  left_out.dropped.area /= frame.scale * frame.scale;
  if (mesh.triangles.empty()) throw InvalidInput("no surface found: the oriented points do not enclose a volume");
  if (inside_out) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  if (far_share != nullptr) *far_share = mesh::far_share(mesh, oriented.cloud.points(), mesh::kFarSpacings);
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
  if (options.preset == Preset::kPaper && chosen.mesher == Mesher::kPoisson && chosen.depth == 0) chosen.depth = kPaperDepth;
  return chosen;
}

// Orientation and mesh come one after the other. What Open3D will take is not known.
std::size_t planned(const Stats& stats, const MeshOptions& chosen) {
  if (chosen.mesher == Mesher::kPoisson) return stats.planned_memory_bytes;
  return std::max(stats.planned_memory_bytes, field_mesh_memory(stats.used, stats.spacing, stats.noise, stats.box_side, chosen.depth));
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
                   Dropped* dropped) {
  if (points.count != normals.count) {
    throw InvalidInput(std::to_string(points.count) + " points but " + std::to_string(normals.count) + " normals");
  }
  if (options.threads < 0) throw InvalidInput("threads must be 0 (all cores) or positive");
  require_usable(options);
  require_meshable(points);
  std::vector<Vec3> kept;
  std::vector<Vec3> directions;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 p = points[i];
    const Vec3 n = normals[i];
    const double size = std::hypot(n[0], n[1], n[2]);
    if (!std::isfinite(p[0] + p[1] + p[2]) || !std::isfinite(size) || size <= 0) continue;
    kept.push_back(p);
    directions.push_back({n[0] / size, n[1] / size, n[2] / size});
  }
  return parallel::with_threads(options.threads, [&] {
    const gpu::Scope device(options.device, kept.size());
    OrientedCloud oriented = oriented_cloud(kept, directions);
    std::vector<Vec3>().swap(kept);  // their memory is wanted
    std::vector<Vec3>().swap(directions);
    mesh::LeftOut left_out;
    Mesh mesh = make_mesh(std::move(oriented), options, monitor, left_out);
    if (dropped != nullptr) *dropped = left_out.dropped;
    return mesh;
  });
}

Reconstruction reconstruct(const PointsView& points, const Options& options, const MeshOptions& mesh_options, const Monitor& monitor) {
  if (mesh_options.mesher == Mesher::kPoisson) require_screened_poisson();
  require_usable(mesh_options);
  require_meshable(points);
  const MeshOptions chosen = choose(mesh_options, options);
  if (options.max_memory > 0) require_memory(plan(points, options, mesh_options).planned_memory_bytes, options);
  Reconstruction out;
  const gpu::Scope device(options.device, points.count);  // one for both steps
  out.orientation = orient(points, options, monitor);
  out.orientation.stats.planned_memory_bytes = planned(out.orientation.stats, chosen);
  Stages stages(monitor);
  stages.time_device([&device] { return device.seconds(); });
  stages.begin("mesh");
  double far = 0;
  parallel::with_threads(options.threads, [&] {
    const gpu::Scope same_device(options.device, points.count);
    OrientedCloud oriented = oriented_cloud(points, out.orientation.normals, out.orientation.areas);
    mesh::LeftOut left_out{outliers_of(points, out.orientation), {}};
    MeshMemory memory{options.max_memory, 0};
    out.mesh = make_mesh(std::move(oriented), chosen, monitor, left_out, &memory, &far);
    std::size_t& planned_bytes = out.orientation.stats.planned_memory_bytes;
    planned_bytes = std::max(planned_bytes, memory.needed);
    out.check = check_mesh(out.mesh);
    out.check.dropped = left_out.dropped;
    carry_attributes(out.mesh, points, {}, out.orientation.confidence);
  });
  device.describe(out.orientation.stats);
  if (far > kDoubtful) {
    Stats& stats = out.orientation.stats;
    const bool is_noisy = stats.noise > mesh::kNoisy * stats.spacing;
    stats.warnings.push_back(percent(far) + " of the surface is farther than " + short_number(mesh::kFarSpacings) +
                             " spacings from any point: the cloud looks open" +
                             (is_noisy ? ", as do two walls that are no farther apart than its noise" : "") + "; trim the mesh (--open)");
    stats.doubtful = stats.doubtful || (far > kManyUnsure && chosen.trim == MeshOptions::Trim::kOff);
  }
  warn_of_topology(out.check, out.orientation.stats);
  warn_of_faces(out.mesh.triangles.size(), chosen.faces, out.orientation.stats.warnings);
  const double widest = std::ldexp(mesh::kFinestCell, mesh::kMaxOctreeLevel) * out.orientation.stats.spacing;  // that the octree resolves
  if (chosen.mesher == Mesher::kField && chosen.depth == 0 && out.orientation.stats.box_side > widest) {
    out.orientation.stats.warnings.emplace_back(
        "the cloud is more than 800,000 spacings wide, so the mesh is coarser than the points: mesh parts that are far apart one by one");
  }
  const bool trimmed = chosen.trim != MeshOptions::Trim::kOff;
  if ((!out.check.closed && !trimmed) || !out.check.manifold) {
    out.orientation.stats.warnings.emplace_back(out.check.closed ? "the mesh is not manifold" : "the mesh is not closed");
  }
  out.orientation.stats.depth = chosen.depth;
  stages.finish(out.orientation.stats);
  return out;
}

}  // namespace g3r
