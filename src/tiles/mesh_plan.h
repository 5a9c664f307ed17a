// What all tiles of a mesh have in common: the octree's levels, and whose place is whose. mesh.json is made by whoever comes first.
#pragma once

#include "mesh/field_denoise.h"
#include "mesh/field_points.h"
#include "mesh/held_points.h"
#include "tiles/cells.h"
#include "tiles/manifest.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

struct MeshPlan {
  double spacing = 0;  ///< typical, in the unit frame
  mesh::Noise noise;   ///< of the cloud
  mesh::CloudHeights heights;
  bool inside_out = false;  ///< the points face into the solid: normals are turned, and so are triangles in the end
  std::vector<Tile> tiles;  ///< `solved`: points of its own and around them
  std::uint64_t worker_memory = 0;
};

/// A work folder, its mesh planned.
struct MeshFolder {
  std::string folder;
  Manifest manifest;
  Cells cells;
  MeshPlan plan;
  std::vector<std::uint64_t> first_code;  ///< of each tile, 0 for the first: every cell is in the tile at or before whose code its own is

  [[nodiscard]] std::size_t tiles() const { return plan.tiles.size(); }
  /// The tile that a cell of cells.level is in, occupied or not.
  [[nodiscard]] std::size_t owner(std::uint64_t code) const;
  /// Place of the first point of a tile in the order.
  [[nodiscard]] std::uint64_t first_point(std::size_t tile) const {
    return cells.cells[static_cast<std::size_t>(plan.tiles[tile].first_cell)].begin;
  }
  [[nodiscard]] mesh::LevelRule levels() const;
};

/// Cells around the places of a tile whose points it needs: leaves that touch its places, those beside them, and points whose discs reach
/// there, one cell each.
inline constexpr int kAround = 3;

/// The places of a tile: a range of Morton codes, occupied or not.
class Region {
 public:
  Region(const MeshFolder& folder, std::size_t tile);

  [[nodiscard]] bool owns(std::uint64_t code) const { return code >= begin_ && code < end_; }
  /// Whether a cell of `level`, no deeper than that of the cells, is at most `reach` such cells from one with a place of the tile.
  [[nodiscard]] bool is_near(std::uint64_t code, int level, int reach) const;
  /// For every occupied cell 0 if it is at most kAround cells away, r where that holds of the cells r levels up.
  [[nodiscard]] std::vector<std::uint8_t> rings() const;

 private:
  void mark(int level, std::uint64_t code, std::size_t first, std::size_t last, std::vector<std::uint8_t>& rings) const;

  const Cells& cells_;
  int level_;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
};

/// Code of the cell of `level` that holds a place in the grid of octree corners.
[[nodiscard]] std::uint64_t cell_at(const std::array<std::uint32_t, 3>& grid, int level);

/// The tiles of the mesh, as the plan of the mesh will have them: nothing but the cells is needed. Throws InvalidInput, Unavailable.
[[nodiscard]] MeshFolder with_mesh_tiles(const std::string& folder, const Manifest& manifest);
/// Reads the plan of the mesh, or makes it. All tiles of normals must be done. Throws InvalidInput, Unavailable, IoError, Cancelled.
[[nodiscard]] MeshFolder open_mesh_folder(const std::string& folder, const Manifest& manifest, const std::atomic<bool>* cancel);
/// Reads it, or throws InvalidInput where there is none.
[[nodiscard]] MeshFolder read_mesh_folder(const std::string& folder, const Manifest& manifest);

}  // namespace g3r::tiles
