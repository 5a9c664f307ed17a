#include "mesh/field_mesher.h"

#include "base/vector.h"
#include "base/whole_bytes.h"
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
using mesh::kFinestCell;
using mesh::Octree;
using mesh::Prepared;
using mesh::RefineDisc;

// The side of the octree over the longest side of the bounding box: beyond kBeyond on both sides all is outside, as the octree's boundary
// has to be.
constexpr double kMargin = 1 + 2 * mesh::kBeyond;

// Peak memory, measured (docs/evidence/meshes.md). If it is planned too small a run is killed, if too large it is refused for nothing.
constexpr double kBaseBytes = 25 << 20;    // Code, libraries, the stacks of threads, and queries of a sum take so many.
constexpr double kBytesPerPoint = 340;     // A point takes so many, those of the winding field included.
constexpr double kBytesPerLeaf = 85;       // A leaf takes so many,
constexpr double kBytesPerThinLeaf = 270;  // and one of a thin wall or gap so many: most of its corners are ambiguous.
constexpr double kFewLeaves = 4000;        // Clouds of few points have so many beside: 300 on a sphere have 3,300, 1,500 have 2,000.
constexpr double kPlainLeaves = 8.6;       // A point of a shape without thin walls has 5.7 to 8.6 leaves; what exceeds this is thin.
// The thickness of the layer that is refined, in cells of the automatic depth.
constexpr double kThickness = 2 * mesh::kDiscHalf / kFinestCell;

// What is done, each of which takes about as long.
enum class Done : std::uint8_t { kNothing, kNoise, kSmoothing, kOctree, kSigns, kHandles, kVertices, kAll };

void report(const Monitor& monitor, Done done) {
  if (monitor.cancel != nullptr && monitor.cancel->load()) throw Cancelled();
  const double fraction = static_cast<double>(done) / static_cast<double>(Done::kAll);
  if (monitor.progress && !monitor.progress("mesh", fraction)) throw Cancelled();
}

// `depth`: 0 for the automatic one.
std::size_t memory_for(std::size_t points, double leaves, int depth) {
  const double thin = depth > 0 ? 0 : std::max(0.0, leaves - kPlainLeaves * static_cast<double>(points));
  return whole_bytes(kBaseBytes + kBytesPerPoint * static_cast<double>(points) + kBytesPerLeaf * (leaves - thin) +
                     kBytesPerThinLeaf * thin);
}

vector::Box box_of(const std::vector<Vec3>& points) {
  vector::Box box;
  for (const Vec3& p : points) box.extend(p);
  return box;
}

// The side of the octree around points of a typical spacing in a box with this longest side, with room for all surface that is no guess.
double octree_side(double spacing, double longest_side) { return longest_side * kMargin + 2 * mesh::kFarSpacings * spacing; }

// The cube of the octree and its levels around points.
struct Levels {
  double side = 0;
  mesh::LevelRule rule;
};

Levels levels_of(const Prepared& prepared, double longest_side, int depth) {
  const double h = prepared.typical;
  Levels out{octree_side(h, longest_side), {h, depth}};
  if (depth == 0) {
    const double cell = mesh::cell_under(prepared.noise) * h;
    const int level = static_cast<int>(std::ceil(std::log2(out.side / cell)));
    out.rule.finest = std::clamp(level, kBaseLevel, mesh::kMaxOctreeLevel);
    // Leaves are as large as asked for, but where the base level is finer: what few points surround is lost between large ones.
    if (level >= kBaseLevel) out.side = std::max(out.side, cell * std::exp2(out.rule.finest));
  } else {
    out.rule.finer = 0;
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

void find_memory(std::size_t points, const Octree& octree, int depth, MeshMemory& memory) {
  memory.needed = memory_for(points, static_cast<double>(octree.leaf_count()), depth);
  if (memory.limit == 0 || memory.needed <= memory.limit) return;
  throw Unavailable("the mesh needs " + std::to_string(mebibytes(memory.needed)) + " MiB, the limit is " +
                    std::to_string(mebibytes(memory.limit)) + " MiB; raise the limit, lower the depth or thin the cloud");
}

// Polygons, and the places and normals of their vertices.
struct PlacedSurface {
  mesh::DualSurface surface;
  mesh::PlacedVertices vertices;
};

// Steps 2 to 6: all else that they hold is gone when the polygons are cut into triangles.
PlacedSurface placed_surface(const Prepared& prepared, const std::vector<double>& size, const FieldSampler& sampler,
                             const MeshOptions& options, const Monitor& monitor, MeshMemory* memory) {
  const mesh::OrientedPoints& oriented = prepared.points;
  const mesh::LocalFit local(oriented, *prepared.neighbours, prepared.near);
  const vector::Box box = box_of(oriented.positions);
  const Levels levels = levels_of(prepared, box.longest_side(), options.depth);
  const Octree octree = make_octree(prepared, size, levels, box, monitor);
  if (memory != nullptr) find_memory(oriented.positions.size(), octree, options.depth, *memory);
  report(monitor, Done::kOctree);
  // Every evaluation of the field sums the points anew, so fewer places at once than two a point take longer, and more take memory.
  const mesh::CornerSides side(local, sampler, prepared.typical, {box.centre(), box.longest_side()}, mesh::level_places(oriented.positions),
                               2 * oriented.positions.size());
  const auto all = [](std::uint32_t) { return true; };
  mesh::Corners corners = side.of(octree, all, monitor.cancel);
  std::vector<float>& value = corners.value;
  std::vector<std::uint8_t> inside(value.size());
  for (std::size_t c = 0; c < value.size(); ++c) inside[c] = value[c] > 0 && !octree.on_boundary(c) ? 1 : 0;
  report(monitor, Done::kSigns);

  const auto centre_inside = [&](const std::vector<Vec3>& centres) { return mesh::sides_by_fit(local, centres); };
  const long most_per_handle = mesh::most_per_handle(prepared.noise, std::ldexp(levels.side, -levels.rule.finest) / prepared.typical);
  mesh::remove_handles(octree, corners.ambiguous, all, most_per_handle, centre_inside, inside, monitor.cancel);
  corners.ambiguous = {};
  mesh::match_values(octree, inside, prepared.typical, value);
  report(monitor, Done::kHandles);
  PlacedSurface out{mesh::contour(octree, inside, centre_inside, monitor.cancel), {}};
  out.vertices = mesh::place_vertices(octree, out.surface, value, local, monitor.cancel);
  report(monitor, Done::kVertices);
  return out;
}

Mesh raw_mesh(const Prepared& prepared, const std::vector<double>& size, const FieldSampler& sampler, const MeshOptions& options,
              const Monitor& monitor, MeshMemory* memory) {
  PlacedSurface placed = placed_surface(prepared, size, sampler, options, monitor, memory);
  return mesh::triangulate(placed.surface, std::move(placed.vertices.positions), placed.vertices.normals);
}

}  // namespace

std::size_t field_mesh_memory(std::size_t points, double spacing, double noise, double longest_side, int depth) {
  double leaves = kPlainLeaves;
  if (depth == 0 && spacing > 0) {
    const double larger = mesh::cell_under(mesh::noise_seen({noise / spacing, 0})) / kFinestCell;
    leaves /= larger * larger;
  }
  if (depth > 0 && longest_side > 0) {
    // So many cells of its own are as wide as one of the automatic depth; a finer one refines the layer and one cell on both sides of it.
    // Nine points at depth 10 took 2.3 GiB of 3.3 planned so.
    const double finer = kFinestCell * spacing * std::exp2(depth) / octree_side(spacing, longest_side);
    leaves *= std::max(1.0, finer * finer * (kThickness * finer + 2) / (kThickness + 2));
  }
  return memory_for(points, leaves * static_cast<double>(points) + (depth == 0 ? kFewLeaves : 0), depth);
}

Mesh field_mesh(const std::vector<Vec3>& points, std::vector<Vec3> normals, const FieldSampler& sampler, const MeshOptions& options,
                const Monitor& monitor, MeshMemory* memory, mesh::LeftOut* left_out) {
  if (points.size() != normals.size()) throw InvalidInput("points and normals differ in number");
  if (points.size() < 4) throw InvalidInput("a mesh needs at least 4 points");
  if (options.depth != 0 && (options.depth < kLeastMeshDepth || options.depth > kMostMeshDepth))
    throw InvalidInput("mesh depth must be 4 to 12");
  report(monitor, Done::kNothing);
  Prepared prepared;
  mesh::prepare(points, std::move(normals), 0, prepared);
  mesh::Noise noise = mesh::estimate_noise(prepared.points, *prepared.neighbours, prepared.typical);
  if (options.noise.unit != Length::Unit::kAuto) noise.position = options.noise.value / prepared.typical;
  report(monitor, Done::kNoise);
  mesh::smooth_noise(noise, monitor.cancel, prepared);
  report(monitor, Done::kSmoothing);
  std::vector<double> size = mesh::sizes_to_resolve(prepared);
  const std::vector<std::uint8_t> in_lines = mesh::points_in_lines(prepared.points.positions, prepared.near);
  Mesh mesh = raw_mesh(prepared, size, sampler, options, monitor, memory);
  size = mesh::lengths_to_carry(prepared, size);
  prepared.neighbours.reset();
  std::vector<std::uint32_t>().swap(prepared.near);  // not only emptied
  mesh::make_fair(mesh, prepared.points.positions, in_lines, monitor.cancel);
  // A depth that was asked for is the size of triangles that was asked for.
  if (options.depth == 0) mesh::coarsen(mesh, prepared.points.positions, size, monitor.cancel);
  mesh::soften_thorns(mesh, mesh::untangle(mesh, monitor.cancel));
  mesh::LeftOut nothing;
  mesh::finish_mesh(mesh, prepared.points, prepared.noise, options, left_out != nullptr ? *left_out : nothing);
  report(monitor, Done::kAll);
  return mesh;
}

}  // namespace g3r
