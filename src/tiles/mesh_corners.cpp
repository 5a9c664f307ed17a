// Pass 2.
#include "base/median.h"
#include "base/pair_key.h"
#include "base/vector.h"
#include "cloud/morton.h"
#include "field/areas.h"
#include "field/winding_sampler.h"
#include "io/output_file.h"
#include "mesh/field_corners.h"
#include "mesh/field_labellings.h"
#include "tiles/mesh_passes.h"

#include <g3r/io.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace g3r::tiles {
namespace {

// Of rings 1 and up of one tile: nodes one level finer than the cells that are too far to be seen point by point.
void add_far_nodes(const MeshFolder& folder, std::size_t tile, const std::vector<std::uint8_t>& rings, std::vector<Vec3>& points,
                   std::vector<Vec3>& eta) {
  const Cells& cells = folder.cells;
  const Tile& of = folder.plan.tiles[tile];
  int deepest = -1;
  for (auto c = static_cast<std::size_t>(of.first_cell); c < of.last_cell; ++c) {
    if (rings[c] > 0) deepest = std::max(deepest, std::min(cells.level - rings[c] + 2, cells.level + 1));
  }
  const RecordFile<FarNode> file(mesh_far_path(folder.folder, tile));
  std::vector<FarNode> nodes;
  for (std::uint64_t at = 0; at < file.size() && deepest >= 0; at += kRecordsAtOnce) {
    nodes.clear();
    file.append(at, std::min(file.size(), at + kRecordsAtOnce), nodes);
    for (const FarNode& node : nodes) {
      if (node.key == 0) throw InvalidInput(escape_text(mesh_far_path(folder.folder, tile)) + ": damaged; remove it, and mesh again");
      const int level = (63 - std::countl_zero(node.key)) / 3;
      if (level > deepest) return;
      const std::uint64_t code = node.key ^ std::uint64_t{1} << (3 * level);
      const std::uint64_t cell = level > cells.level ? code >> 3 : code << (3 * (cells.level - level));
      const auto begin = cells.cells.begin() + static_cast<std::ptrdiff_t>(of.first_cell);
      const auto end = cells.cells.begin() + static_cast<std::ptrdiff_t>(of.last_cell);
      const auto found = std::partition_point(begin, end, [&](const Cell& c) { return c.code < cell; });
      if (found == end) continue;
      const int ring = rings[static_cast<std::size_t>(found - cells.cells.begin())];
      if (ring == 0 || level != std::min(cells.level - ring + 2, cells.level + 1)) continue;
      points.push_back(node.place);
      eta.push_back({node.eta[0], node.eta[1], node.eta[2]});
    }
  }
}

// Everything that the field of a tile is summed from.
OrientedCloud field_sources(const MeshFolder& folder, const Surroundings& around) {
  const mesh::OrientedPoints& near = around.prepared.points;
  std::vector<Vec3> points = near.positions;
  std::vector<Vec3> eta;
  for (std::size_t i = 0; i < points.size(); ++i) eta.push_back(vector::scale(near.normals[i], near.spacing[i] * near.spacing[i]));
  for (std::size_t t = 0; t < folder.tiles(); ++t) add_far_nodes(folder, t, around.rings, points, eta);
  const std::vector<std::uint32_t> order = morton_order(points);
  OrientedCloud out;
  std::vector<Vec3> sorted;
  for (const std::uint32_t i : order) {
    sorted.push_back(points[i]);
    out.eta.push_back(eta[i]);
  }
  out.cloud.set = PointSet(std::move(sorted));
  out.spacing = folder.plan.spacing;
  return out;
}

// Areas such that the field is 1/2 on the surface, as it is on a closed one.
void scale_areas(OrientedCloud& sources, const std::vector<Vec3>& places, const std::atomic<bool>* cancel) {
  std::vector<double> field;
  WindingSampler(sources, cancel).sample(places, field, nullptr);
  const double factor = area_factor(median(std::move(field)));
  for (Vec3& v : sources.eta) v = vector::scale(v, factor);
}

// Corners that may change sides to remove a handle: no other tile changes one of the same leaf, so what a change does to the surface is
// what it seems to do here.
std::vector<std::uint8_t> free_corners(const mesh::Octree& octree, const std::vector<std::uint8_t>& owned) {
  std::vector<std::uint8_t> free = owned;
  for (std::size_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    const auto& corners = octree.corners(leaf);
    if (std::all_of(corners.begin(), corners.end(), [&](std::uint32_t c) { return owned[c] != 0; })) continue;
    for (const std::uint32_t c : corners) free[c] = 0;
  }
  return free;
}

// Corners that are inside, and those outside that an edge of the surface may end at; all others are outside.
std::vector<CornerValue> worth_saying(const Surroundings& around, const std::vector<std::uint8_t>& owned, const std::vector<float>& value,
                                      const std::vector<std::uint8_t>& inside) {
  const mesh::Octree& octree = *around.octree;
  std::vector<std::uint8_t> said = inside;
  for (std::size_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    const auto& corners = octree.corners(leaf);
    const bool may_cross = std::any_of(corners.begin(), corners.end(), [&](std::uint32_t c) { return inside[c] != 0 || owned[c] == 0; });
    for (const std::uint32_t c : corners) said[c] |= may_cross ? 1 : 0;
  }
  std::vector<CornerValue> out;
  for (std::uint32_t c = 0; c < said.size(); ++c) {
    if (said[c] == 0 || owned[c] == 0) continue;
    const std::uint64_t name = corner_name(octree.corner_grid(c));
    out.push_back({{second_of(name), first_of(name)}, value[c]});
  }
  std::sort(out.begin(), out.end(), [](const CornerValue& a, const CornerValue& b) { return a.whole_key() < b.whole_key(); });
  return out;
}

}  // namespace

void write_corners(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel) {
  const Surroundings around(folder, tile, cancel);
  const mesh::Octree& octree = *around.octree;
  const mesh::Prepared& prepared = around.prepared;
  const int level = folder.cells.level;
  std::vector<std::uint8_t> owned(octree.corner_count());
  for (std::uint32_t c = 0; c < owned.size(); ++c)
    owned[c] = !octree.on_boundary(c) && around.region.owns(cell_at(octree.corner_grid(c), level)) ? 1 : 0;

  std::vector<Vec3> own;
  for (const std::uint32_t i : around.own) own.push_back(prepared.points.positions[i]);
  const std::vector<Vec3> places = mesh::level_places(own);
  const mesh::LocalFit local(prepared.points, *prepared.neighbours, prepared.near);
  mesh::Corners corners;
  {
    OrientedCloud sources = field_sources(folder, around);
    scale_areas(sources, places, cancel);
    const WindingSampler field(sources, cancel);
    const mesh::CornerSides sides(local, field, prepared.typical, {{0, 0, 0}, kLongestSide}, places, mesh::kAskedPerPoint * own.size());
    corners = sides.of(
        octree, [&](std::uint32_t c) { return owned[c] != 0; }, cancel);
  }
  std::vector<std::uint8_t> inside(owned.size());
  for (std::size_t c = 0; c < inside.size(); ++c) inside[c] = owned[c] != 0 && corners.value[c] > 0 ? 1 : 0;
  const mesh::InsideTest joined = joining_rule(folder, prepared, local);
  const std::vector<std::uint8_t> free = free_corners(octree, owned);
  const double cell = std::ldexp(2.0, -folder.levels().finest) / folder.plan.spacing;
  const mesh::HandlePrice price{[&](std::uint32_t c) { return free[c] != 0; },
                                [&](const Vec3& within, const Vec3& outside) { return mesh::is_held(local, within, outside); },
                                mesh::most_per_handle(mesh::noise_seen(folder.plan.noise), cell)};
  mesh::remove_handles(octree, corners.ambiguous, price, joined, inside, cancel);
  mesh::match_values(octree, inside, prepared.typical, corners.value);

  const std::vector<CornerValue> values = worth_saying(around, owned, corners.value, inside);
  io::OutputFile out(mesh_corners_path(folder.folder, tile), cancel);
  out.write_records(values);
  out.commit();
}

}  // namespace g3r::tiles
