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

// Which corners of the octree are inside, and the values by which vertices are placed.
struct Signs {
  std::vector<float> value;
  std::vector<std::uint8_t> inside;
};

// Polygons, and the places and normals of their vertices.
struct PlacedSurface {
  mesh::DualSurface surface;
  mesh::PlacedVertices vertices;
};

// From prepared points to polygons with their vertices. What it holds besides is gone when the polygons are cut into triangles.
class SurfaceMaker {
 public:
  // All are kept by reference. `memory`: may be null.
  SurfaceMaker(const Prepared& prepared, const FieldSampler& sampler, const MeshOptions& options, const Monitor& monitor,
               MeshMemory* memory)
      : prepared_(prepared),
        sampler_(sampler),
        options_(options),
        monitor_(monitor),
        memory_(memory),
        local_(prepared.points, *prepared.neighbours, prepared.near),
        box_(box_of(prepared.points.positions)) {
    choose_levels();
  }

  // `size`: of sizes_to_resolve().
  [[nodiscard]] PlacedSurface make(const std::vector<double>& size) const {
    const Octree octree = make_octree(size);
    if (memory_ != nullptr) mesh::check_memory(prepared_.points.positions.size(), octree.leaf_count(), options_.depth, *memory_);
    report(monitor_, Done::kOctree);
    const auto centre_inside = [&](const std::vector<Vec3>& centres) { return mesh::sides_by_fit(local_, centres); };
    const Signs signs = find_signs(octree, centre_inside);
    PlacedSurface out{mesh::contour(octree, signs.inside, centre_inside, monitor_.cancel), {}};
    out.vertices = mesh::place_vertices(octree, out.surface, signs.value, local_, monitor_.cancel);
    report(monitor_, Done::kVertices);
    return out;
  }

 private:
  // The side of the octree's cube, and the levels of its leaves around points.
  void choose_levels() {
    const double h = prepared_.typical;
    side_ = mesh::octree_side(h, box_.longest_side());
    rule_ = {h, options_.depth};
    if (options_.depth != 0) {
      rule_.deepens = false;
      return;
    }
    const double cell = mesh::cell_under(prepared_.noise) * h;
    const int level = static_cast<int>(std::ceil(std::log2(side_ / cell)));
    rule_.finest = std::clamp(level, kBaseLevel, mesh::kMaxOctreeLevel);
    // Leaves are as large as asked for, but where the base level is finer: what few points surround is lost between large ones.
    if (level >= kBaseLevel) side_ = std::max(side_, cell * std::exp2(rule_.finest));
  }

  [[nodiscard]] Octree make_octree(const std::vector<double>& size) const {
    const mesh::OrientedPoints& points = prepared_.points;
    const double half = 0.5 * side_;
    std::vector<RefineDisc> requests(points.positions.size());
    for (std::size_t i = 0; i < requests.size(); ++i)
      requests[i] = mesh::disc_around(points.positions[i], points.normals[i], points.spacing[i], size[i], rule_);
    return Octree(vector::subtract(box_.centre(), {half, half, half}), side_, requests, std::min(kBaseLevel, rule_.finest),
                  monitor_.cancel);
  }

  [[nodiscard]] Signs find_signs(const Octree& octree, const mesh::InsideTest& centre_inside) const {
    const std::vector<Vec3>& positions = prepared_.points.positions;
    const mesh::CornerSides side(local_, sampler_, prepared_.typical, {box_.centre(), box_.longest_side()}, mesh::level_places(positions),
                                 mesh::kAskedPerPoint * positions.size());
    const auto all = [](std::uint32_t) { return true; };
    mesh::Corners corners = side.of(octree, all, monitor_.cancel);
    Signs out{std::move(corners.value), std::vector<std::uint8_t>(octree.corner_count())};
    for (std::size_t c = 0; c < out.inside.size(); ++c) out.inside[c] = out.value[c] > 0 && !octree.on_boundary(c) ? 1 : 0;
    report(monitor_, Done::kSigns);
    const double cell = std::ldexp(side_, -rule_.finest) / prepared_.typical;
    const auto held = [&](const Vec3& within, const Vec3& outside) { return mesh::is_held(local_, within, outside); };
    mesh::remove_handles(octree, corners.ambiguous, {all, held, mesh::most_per_handle(prepared_.noise, cell)}, centre_inside, out.inside,
                         monitor_.cancel);
    mesh::match_values(octree, out.inside, prepared_.typical, out.value);
    report(monitor_, Done::kHandles);
    return out;
  }

  const Prepared& prepared_;
  const FieldSampler& sampler_;
  const MeshOptions& options_;
  const Monitor& monitor_;
  MeshMemory* memory_;
  const mesh::LocalFit local_;
  const vector::Box box_;  // of the points
  double side_ = 0;
  mesh::LevelRule rule_;
};

Mesh raw_mesh(const Prepared& prepared, const std::vector<double>& size, const FieldSampler& sampler, const MeshOptions& options,
              const Monitor& monitor, MeshMemory* memory) {
  PlacedSurface placed = SurfaceMaker(prepared, sampler, options, monitor, memory).make(size);
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
  mesh::Noise noise = mesh::noise_about_fits(prepared.points, *prepared.neighbours, prepared.typical);
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
