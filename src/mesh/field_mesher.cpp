#include "mesh/field_mesher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/whole_bytes.h"
#include "g3r/error.h"
#include "g3r/names.h"
#include "mesh/fair.h"
#include "mesh/field_contour.h"
#include "mesh/field_corners.h"
#include "mesh/field_local_fit.h"
#include "mesh/field_octree.h"
#include "mesh/field_placement.h"
#include "mesh/field_points.h"
#include "mesh/field_readings.h"
#include "mesh/mesh_finish.h"
#include "mesh/untangle.h"

namespace g3r {
namespace {

using mesh::kBaseLevel;
using mesh::kFinestCell;
using mesh::Octree;
using mesh::Prepared;
using mesh::RefineDisc;

// The side of the octree over the longest side of the bounding box, to which 8 spacings are added: surface that closes an open scan may lie
// 0.05 of that side outside of the box (CornerSides), and the octree's boundary is outside of all.
constexpr double kMargin = 1.15;

// The places, per point, at which the field is evaluated at once: every evaluation sums the points anew, so fewer take longer, and more
// take memory.
constexpr std::size_t kAskedPerPoint = 2;

// Peak memory, measured (docs/evidence/meshes.md). If it is planned too small a run is killed, if too large it is refused for nothing.
constexpr double kBaseBytes = 26 << 20;  // Code, libraries (those of E57 are a third) and the stacks of threads take so many.
constexpr double kBytesPerPoint = 500;   // A point takes so many, those of the winding field included.
constexpr double kBytesPerLeaf = 210;    // A leaf takes so many,
constexpr double kBytesPerThin = 430;    // but one that a thin wall or gap adds more, because most of its corners are ambiguous.
constexpr double kPlainLeaves = 8.5;     // A point of a shape without thin walls has 5.7 to 8.6 leaves; what exceeds this is thin.
constexpr double kLeavesPerPoint = 9.5;  // The plan before the solve, which knows of no thin walls, takes so many.
// A given depth that is finer than the automatic one refines a layer of this thickness, in cells of the automatic depth, and as many cells
// of its own around it: nine points at depth 10 took 2.3 GiB of 3.3 planned so.
constexpr double kThickness = 0.75;
constexpr double kLayers = 2;

void report(const Monitor& monitor, double fraction) {
  if (monitor.cancel != nullptr && monitor.cancel->load()) throw Cancelled();
  if (monitor.progress && !monitor.progress("mesh", fraction)) throw Cancelled();
}

// `depth`: 0 for the automatic one.
std::size_t memory_for(std::size_t points, double leaves, int depth) {
  const double plain = std::min(leaves, kPlainLeaves * static_cast<double>(points));
  const double octree = kBytesPerLeaf * plain + (depth > 0 ? kBytesPerLeaf : kBytesPerThin) * (leaves - plain);
  return whole_bytes(kBaseBytes + kBytesPerPoint * static_cast<double>(points) + octree);
}

struct Box {
  Vec3 low, high;
  [[nodiscard]] double longest() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
  [[nodiscard]] double centre(std::size_t a) const { return 0.5 * (low[a] + high[a]); }
};

Box box_of(const std::vector<Vec3>& points) {
  Box box{points[0], points[0]};
  for (const Vec3& p : points) {
    for (std::size_t a = 0; a < 3; ++a) box.low[a] = std::min(box.low[a], p[a]), box.high[a] = std::max(box.high[a], p[a]);
  }
  return box;
}

Octree make_octree(const Prepared& prepared, const MeshOptions& options, const Monitor& monitor) {
  const mesh::OrientedPoints& points = prepared.points;
  const Box box = box_of(points.positions);
  const double h = prepared.typical;
  double side = box.longest() * kMargin + 8 * h;
  mesh::LevelRule rule{h, options.depth};
  if (options.depth == 0) {
    rule.finest = std::clamp(static_cast<int>(std::ceil(std::log2(side / (kFinestCell * h)))), kBaseLevel, mesh::kMaxOctreeLevel);
    side = std::max(side, kFinestCell * h * std::exp2(rule.finest));
  } else {
    rule.finer = 0;
  }
  Vec3 corner{};
  for (std::size_t a = 0; a < 3; ++a) corner[a] = box.centre(a) - 0.5 * side;
  const std::vector<double> size = mesh::sizes_to_resolve(prepared);
  std::vector<RefineDisc> requests(points.positions.size());
  for (std::size_t i = 0; i < requests.size(); ++i)
    requests[i] = mesh::disc_around(points.positions[i], points.normals[i], points.spacing[i], size[i], rule);
  return Octree(corner, side, requests, std::min(kBaseLevel, rule.finest), monitor.cancel);
}

void require_memory_for(std::size_t points, const Octree& octree, int depth, std::size_t max_memory) {
  const std::size_t needed = memory_for(points, static_cast<double>(octree.leaf_count()), depth);
  if (max_memory == 0 || needed <= max_memory) return;
  throw Unavailable("the mesh needs " + std::to_string(needed >> 20U) + " MiB, the limit is " + std::to_string(max_memory >> 20U) +
                    " MiB; raise the limit, lower the depth or thin the cloud");
}

// Steps 2 to 6: all that they hold but the mesh is gone when its crossings are searched for.
Mesh raw_mesh(const Prepared& prepared, const FieldSampler& sampler, const MeshOptions& options, const Monitor& monitor,
              std::size_t max_memory) {
  const mesh::OrientedPoints& oriented = prepared.points;
  const mesh::LocalFit local(oriented, *prepared.neighbours, prepared.near);
  const Octree octree = make_octree(prepared, options, monitor);
  require_memory_for(oriented.positions.size(), octree, options.depth, max_memory);
  report(monitor, 0.3);
  const Box box = box_of(oriented.positions);
  const mesh::CornerSides side(local, sampler, prepared.typical, {{box.centre(0), box.centre(1), box.centre(2)}, box.longest()},
                               mesh::level_places(oriented.positions), kAskedPerPoint * oriented.positions.size());
  const auto all = [](std::uint32_t) { return true; };
  mesh::Corners corners = side.of(octree, all, monitor.cancel);
  std::vector<float>& value = corners.value;
  std::vector<std::uint8_t> inside(value.size());
  for (std::size_t c = 0; c < value.size(); ++c) inside[c] = value[c] > 0 && !octree.on_boundary(c) ? 1 : 0;
  report(monitor, 0.6);

  const auto centre_inside = [&](const std::vector<Vec3>& centres) { return mesh::sides_by_fit(local, centres); };
  mesh::DualSurface surface = mesh::contour(octree, inside, centre_inside, monitor.cancel);
  if (mesh::remove_handles(octree, corners.opinions, all, centre_inside, inside, surface, monitor.cancel)) {
    surface = {};
    surface = mesh::contour(octree, inside, centre_inside, monitor.cancel);
  }
  corners.opinions = {};
  mesh::settle_values(octree, inside, prepared.typical, value);
  report(monitor, 0.7);
  mesh::PlacedVertices placed = mesh::place_vertices(octree, surface, value, local, monitor.cancel);
  report(monitor, 0.95);
  return mesh::triangulate(surface, std::move(placed.positions), placed.normals);
}

}  // namespace

std::size_t field_mesh_memory(std::size_t points, double spacing, double longest_side, int depth) {
  double leaves = kLeavesPerPoint;
  if (depth > 0 && longest_side > 0) {
    const double finer = kFinestCell * spacing * std::exp2(depth) / (kMargin * longest_side + 8 * spacing);
    leaves *= std::max(1.0, finer * finer * (kThickness * finer + kLayers) / (kThickness + kLayers));
  }
  return memory_for(points, leaves * static_cast<double>(points), depth);
}

Mesh field_mesh(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const FieldSampler& sampler, const MeshOptions& options,
                const Monitor& monitor, std::size_t max_memory, mesh::LeftOut* left_out) {
  if (points.size() != normals.size()) throw InvalidInput("points and normals differ in number");
  if (points.size() < 4) throw InvalidInput("a mesh needs at least 4 points");
  if (options.depth != 0 && (options.depth < kLeastMeshDepth || options.depth > kMostMeshDepth))
    throw InvalidInput("mesh depth must be 4 to 12");
  report(monitor, 0);
  Prepared prepared;
  mesh::prepare(points, normals, 0, prepared);
  mesh::Noise noise = mesh::estimate_noise(prepared.points, *prepared.neighbours);
  if (options.noise.unit != Length::Unit::kAuto) noise.position = options.noise.value / prepared.typical;
  report(monitor, 0.05);
  mesh::smooth_noise(noise, monitor.cancel, prepared);
  report(monitor, 0.2);
  Mesh mesh = raw_mesh(prepared, sampler, options, monitor, max_memory);
  mesh::make_fair(mesh, prepared.points.positions, mesh::points_in_lines(prepared.points.positions, prepared.near), monitor.cancel);
  prepared.neighbours.reset();
  std::vector<std::uint32_t>().swap(prepared.near);  // not only emptied
  mesh::untangle(mesh, monitor.cancel);
  mesh::LeftOut nothing;
  mesh::finish_mesh(mesh, prepared.points.positions, prepared.points.spacing, prepared.noise, options,
                    left_out != nullptr ? *left_out : nothing);
  report(monitor, 1);
  return mesh;
}

}  // namespace g3r
