#include "mesh/field_mesher.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "mesh/coarsen.h"
#include "mesh/constants.h"
#include "mesh/fair.h"
#include "mesh/field_contour.h"
#include "mesh/field_corners.h"
#include "mesh/field_labellings.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_octree.h"
#include "mesh/field_placement.h"
#include "mesh/field_points.h"
#include "mesh/lines.h"
#include "mesh/mesh_finish.h"
#include "mesh/mesh_memory.h"
#include "mesh/untangle.h"

#include <g3r/error.h>
#include <g3r/names.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace g3r {
namespace {

using mesh::kBaseLevel;
using mesh::Octree;
using mesh::Prepared;
using mesh::RefineDisc;

// What is done, each of which takes about as long.
enum class Done : std::uint8_t { kNothing, kNoise, kSmoothing, kOctree, kSigns, kHandles, kVertices, kAll };

void report(const Monitor& monitor, Done done) {
  if (monitor.cancel != nullptr && monitor.cancel->load()) throw Cancelled();
  const double fraction = static_cast<double>(done) / static_cast<double>(Done::kAll);
  if (monitor.progress && !monitor.progress("mesh", fraction)) throw Cancelled();
}

vector::Box box_of(const std::vector<Vec3>& points) {
  vector::Box box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

// The cube of the octree and its levels around points.
struct Levels {
  double side = 0;
  mesh::LevelRule rule;
};

Levels levels_of(const Prepared& prepared, double longest_side, int depth) {
  const double h = prepared.typical;
  Levels out{mesh::octree_side(h, longest_side), {h, depth}};
  if (depth == 0) {
    const double cell = mesh::cell_under(prepared.noise) * h;
    const int level = static_cast<int>(std::ceil(std::log2(out.side / cell)));
    out.rule.finest = std::clamp(level, kBaseLevel, mesh::kMaxOctreeLevel);
    // Leaves are as large as asked for, but where the base level is finer: what few points surround is lost between large ones.
    if (level >= kBaseLevel) out.side = std::max(out.side, cell * std::exp2(out.rule.finest));
  } else {
    out.rule.deepens = false;
  }
  return out;
}

// `size`: of sizes_to_resolve().
Octree make_octree(const Prepared& prepared, const std::vector<double>& size, const Levels& levels, const vector::Box& box,
                   const Monitor& monitor) {
  const mesh::OrientedPoints& points = prepared.points;
  const double half = 0.5 * levels.side;
  std::vector<RefineDisc> requests(points.positions.size());
  for (std::size_t i = 0; i < requests.size(); ++i)
    requests[i] = mesh::disc_around(points.positions[i], points.normals[i], points.spacing[i], size[i], levels.rule);
  return Octree(vector::subtract(box.centre(), {half, half, half}), levels.side, requests, std::min(kBaseLevel, levels.rule.finest),
                monitor.cancel);
}

// Which corners of the octree are inside, and the values by which vertices are placed.
struct Signs {
  std::vector<float> value;
  std::vector<std::uint8_t> inside;
};

Signs find_signs(const Octree& octree, const Prepared& prepared, const mesh::LocalFit& local, const FieldSampler& sampler,
                 const mesh::Cube& cube, const mesh::InsideTest& centre_inside, double most_per_handle, const Monitor& monitor) {
  const std::vector<Vec3>& positions = prepared.points.positions;
  const mesh::CornerSides side(local, sampler, prepared.typical, cube, mesh::level_places(positions),
                               mesh::kAskedPerPoint * positions.size());
  const auto all = [](std::uint32_t) { return true; };
  mesh::Corners corners = side.of(octree, all, monitor.cancel);
  Signs out{std::move(corners.value), std::vector<std::uint8_t>(octree.corner_count())};
  for (std::size_t c = 0; c < out.inside.size(); ++c) out.inside[c] = out.value[c] > 0 && !octree.on_boundary(c) ? 1 : 0;
  report(monitor, Done::kSigns);
  mesh::remove_handles(octree, corners.ambiguous, all, most_per_handle, centre_inside, out.inside, monitor.cancel);
  mesh::match_values(octree, out.inside, prepared.typical, out.value);
  report(monitor, Done::kHandles);
  return out;
}

// Polygons, and the places and normals of their vertices.
struct PlacedSurface {
  mesh::DualSurface surface;
  mesh::PlacedVertices vertices;
};

// Octree, signs, polygons and vertices: all else that they hold is gone when the polygons are cut into triangles.
PlacedSurface placed_surface(const Prepared& prepared, const std::vector<double>& size, const FieldSampler& sampler,
                             const MeshOptions& options, const Monitor& monitor, MeshMemory* memory) {
  const mesh::LocalFit local(prepared.points, *prepared.neighbours, prepared.near);
  const vector::Box box = box_of(prepared.points.positions);
  const Levels levels = levels_of(prepared, box.longest_side(), options.depth);
  const Octree octree = make_octree(prepared, size, levels, box, monitor);
  if (memory != nullptr) mesh::check_memory(prepared.points.positions.size(), octree.leaf_count(), options.depth, *memory);
  report(monitor, Done::kOctree);
  const auto centre_inside = [&](const std::vector<Vec3>& centres) { return mesh::sides_by_fit(local, centres); };
  const double most_per_handle = mesh::most_per_handle(prepared.noise, std::ldexp(levels.side, -levels.rule.finest) / prepared.typical);
  const Signs signs =
      find_signs(octree, prepared, local, sampler, {box.centre(), box.longest_side()}, centre_inside, most_per_handle, monitor);
  PlacedSurface out{mesh::contour(octree, signs.inside, centre_inside, monitor.cancel), {}};
  out.vertices = mesh::place_vertices(octree, out.surface, signs.value, local, monitor.cancel);
  report(monitor, Done::kVertices);
  return out;
}

Mesh raw_mesh(const Prepared& prepared, const std::vector<double>& size, const FieldSampler& sampler, const MeshOptions& options,
              const Monitor& monitor, MeshMemory* memory) {
  PlacedSurface placed = placed_surface(prepared, size, sampler, options, monitor, memory);
  return mesh::triangulate(placed.surface, std::move(placed.vertices.positions), placed.vertices.normals);
}

void check_input(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const MeshOptions& options) {
  if (points.size() != normals.size()) throw InvalidInput("points and normals differ in number");
  if (points.size() < kLeastPoints) throw InvalidInput("a mesh needs at least 4 points");
  if (options.depth != 0 && (options.depth < kLeastMeshDepth || options.depth > kMostMeshDepth))
    throw InvalidInput("mesh depth must be 4 to 12");
}

}  // namespace

Mesh field_mesh(const std::vector<Vec3>& points, std::vector<Vec3> normals, const FieldSampler& sampler, const MeshOptions& options,
                const Monitor& monitor, MeshMemory* memory, mesh::Found* found) {
  check_input(points, normals, options);
  report(monitor, Done::kNothing);
  Prepared prepared;
  mesh::prepare(points, std::move(normals), 0, prepared);
  mesh::Noise noise = mesh::estimate_noise(prepared.points, *prepared.neighbours, prepared.typical);
  if (options.noise.unit != Length::Unit::kAuto) noise.position = options.noise.value / prepared.typical;
  report(monitor, Done::kNoise);
  mesh::smooth_noise(noise, monitor.cancel, prepared);
  report(monitor, Done::kSmoothing);
  const std::vector<std::uint8_t> in_lines = mesh::points_in_lines(prepared.points.positions, prepared.near);
  std::vector<double> size = mesh::sizes_to_resolve(prepared, in_lines);
  Mesh mesh = raw_mesh(prepared, size, sampler, options, monitor, memory);
  size = mesh::lengths_to_carry(prepared, size);
  prepared.neighbours.reset();
  std::vector<std::uint32_t>().swap(prepared.near);  // not only emptied
  mesh::make_fair(mesh, prepared.points.positions, in_lines, monitor.cancel);
  // A depth that was asked for is the size of triangles that was asked for.
  if (options.depth == 0) mesh::coarsen(mesh, prepared.points.positions, size, monitor.cancel);
  mesh::soften_thorns(mesh, mesh::untangle(mesh, monitor.cancel), monitor.cancel);
  mesh::Found nothing;
  mesh::Found& out = found != nullptr ? *found : nothing;
  out.noise = prepared.noise * prepared.typical;
  mesh::finish_mesh(mesh, prepared.points, prepared.noise, options, out, monitor.cancel);
  report(monitor, Done::kAll);
  return mesh;
}

}  // namespace g3r
