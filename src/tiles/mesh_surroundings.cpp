// What a tile sees around it.
#include "base/vector.h"
#include "mesh/field_corners.h"
#include "tiles/cell_codes.h"
#include "tiles/mesh_passes.h"

#include <algorithm>
#include <cmath>

namespace g3r::tiles {
namespace {

constexpr int kCoarseAround = 4;  // cells of every coarser level around a tile whose leaves are right: leaves beside those that touch it,
                                  // which are half as large at least
constexpr int kFineAround = 2;    // cells around a tile that have their leaves: those that touch it, and those beside these

bool is_occupied(const Cells& cells, std::uint64_t code, int level) {
  const int up = 3 * (cells.level - level);
  const auto found = std::partition_point(cells.cells.begin(), cells.cells.end(), [&](const Cell& cell) { return cell.code >> up < code; });
  return found != cells.cells.end() && found->code >> up == code;
}

// Whether a node above the level of the cells is split: if it or one beside it holds points.
bool is_split(const Cells& cells, std::uint64_t code, int level) {
  return level < mesh::kBaseLevel || any_neighbour(code, level, 1, [&](std::uint64_t other) { return is_occupied(cells, other, level); });
}

// From the level of the cells on nodes are split by the discs of points.
mesh::SplitRule split_rule(const MeshFolder& folder, const Region& region) {
  return [&folder, &region](const mesh::OctreeNode& node) {
    const int level = node.level;
    const Cells& cells = folder.cells;
    if (level < mesh::kBaseLevel) return mesh::Split::kYes;
    if (level > cells.level) return mesh::Split::kAsRequested;
    const std::uint64_t code = cell_at(node.low, level);
    if (level == cells.level) return region.is_near(code, level, kFineAround) ? mesh::Split::kAsRequested : mesh::Split::kNo;
    return region.is_near(code, level, kCoarseAround) && is_split(cells, code, level) ? mesh::Split::kYes : mesh::Split::kNo;
  };
}

}  // namespace

std::uint64_t corner_name(const std::array<std::uint32_t, 3>& grid) {
  constexpr int kBits = mesh::kMaxOctreeLevel + 1;
  return std::uint64_t{grid[2]} << (2 * kBits) | std::uint64_t{grid[1]} << kBits | grid[0];
}

std::vector<std::size_t> tiles_around(const MeshFolder& folder, std::size_t tile) {
  const std::vector<std::uint8_t> rings = Region(folder, tile).rings();
  std::vector<std::size_t> tiles;
  for (std::size_t t = 0; t < folder.tiles(); ++t) {
    const auto first = rings.begin() + static_cast<std::ptrdiff_t>(folder.plan.tiles[t].first_cell);
    const auto last = rings.begin() + static_cast<std::ptrdiff_t>(folder.plan.tiles[t].last_cell);
    if (t == tile || std::find(first, last, std::uint8_t{0}) != last) tiles.push_back(t);
  }
  return tiles;
}

std::vector<std::size_t> tiles_of_corners(const MeshFolder& folder, std::size_t tile) {
  const Cells& cells = folder.cells;
  const Region region(folder, tile);
  std::vector<std::uint8_t> wanted(folder.tiles(), 0);
  // Corners that leaves beside this one have on it are in the middle of its sides and edges.
  const auto take = [&](const std::array<std::uint32_t, 3>& low, std::uint32_t half) {
    for (std::uint32_t k = 0; k < mesh::kLatticeSize; ++k) {
      const std::uint32_t side = mesh::kLatticeSide;
      wanted[folder.owner(
          cell_at({low[0] + k % side * half, low[1] + k / side % side * half, low[2] + k / (side * side) * half}, cells.level))] = 1;
    }
  };
  const auto visit = [&](const auto& self, std::uint64_t code, int level) -> void {
    if (!region.is_near(code, level, 1)) return;
    if (level < cells.level && is_split(cells, code, level)) {
      for (std::uint64_t child = code << 3; child < (code + 1) << 3; ++child) self(self, child, level + 1);
      return;
    }
    const int up = mesh::kMaxOctreeLevel - level;
    const auto at = [&](std::uint64_t bits) { return static_cast<std::uint32_t>(gather_bits(bits) << up); };
    take({at(code >> 2), at(code >> 1), at(code)}, std::uint32_t{1} << (up - 1));
  };
  visit(visit, 0, 0);
  std::vector<std::size_t> tiles;
  for (std::size_t t = 0; t < wanted.size(); ++t) {
    if (wanted[t] != 0) tiles.push_back(t);
  }
  return tiles;
}

void for_points_around(const MeshFolder& folder, const std::vector<std::uint8_t>& rings,
                       const std::function<void(std::size_t, const MeshPoint&)>& take) {
  const auto tile_of = [&](std::size_t c) { return folder.owner(folder.cells.cells[c].code); };
  std::vector<MeshPoint> read;
  for_runs(
      rings.size(), [&](std::size_t c) { return rings[c] == 0; }, tile_of,
      [&](std::size_t first, std::size_t last) {
        const std::size_t from = tile_of(first);
        read.clear();
        const std::uint64_t before = folder.first_point(from);
        RecordFile<MeshPoint>(mesh_points_path(folder.folder, from))
            .append(folder.cells.cells[first].begin - before, folder.cells.end(last - 1) - before, read);
        for (const MeshPoint& p : read) {
          if (p.spacing > 0) take(from, p);
        }
      });
}

Surroundings::Surroundings(const MeshFolder& folder, std::size_t tile, const std::atomic<bool>* cancel)
    : region(folder, tile), rings(region.rings()) {
  mesh::OrientedPoints& points = prepared.points;
  std::vector<mesh::RefineDisc> discs;
  const mesh::LevelRule levels = folder.levels();
  for_points_around(folder, rings, [&](std::size_t from, const MeshPoint& p) {
    if (from == tile) own.push_back(static_cast<std::uint32_t>(points.positions.size()));
    points.positions.push_back(p.position);
    points.normals.push_back({p.normal[0], p.normal[1], p.normal[2]});
    points.spacing.push_back(p.spacing);
    mesh::RefineDisc disc = mesh::disc_around(p.position, points.normals.back(), p.spacing, p.size, levels);
    disc.radius = std::min(disc.radius, double{p.room});
    if (disc.radius > 0) discs.push_back(disc);
  });
  mesh::find_neighbours(prepared);
  prepared.typical = folder.plan.spacing;
  octree = std::make_unique<mesh::Octree>(Vec3{-1, -1, -1}, 2, discs, split_rule(folder, region), cancel);
}

mesh::InsideTest joining_rule(const MeshFolder& folder, const mesh::Prepared& prepared, const mesh::LocalFit& local) {
  const double cell = std::ldexp(2.0, -folder.cells.level);
  return [cell, &prepared, &local](const std::vector<Vec3>& places) {
    std::vector<std::uint8_t> inside = mesh::sides_by_fit(local, places);
    const std::vector<Vec3>& points = prepared.points.positions;
    const std::size_t near = prepared.near.size() / points.size();
    const auto distance = [](const Vec3& a, const Vec3& b) {
      const Vec3 d = vector::subtract(a, b);
      return std::sqrt(vector::dot(d, d));
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (inside[i] == 0) continue;
      double squared = cell * cell;
      const std::uint32_t nearest = prepared.neighbours->nearest(places[i], squared, static_cast<std::uint32_t>(points.size()));
      if (nearest == points.size()) {
        inside[i] = 0;
        continue;
      }
      const std::uint32_t last = prepared.near[(nearest + 1) * near - 1];
      if (!(std::sqrt(squared) + distance(points[nearest], points[last]) < cell)) inside[i] = 0;
    }
    return inside;
  };
}

}  // namespace g3r::tiles
