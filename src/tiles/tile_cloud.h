// The cloud that is solved for a tile: its own points, those of a halo around them, and thinned ones beyond, fewer the farther away.
#pragma once

#include "base/stages.h"
#include "tiles/cells.h"
#include "tiles/manifest.h"
#include "tiles/records.h"

#include <g3r/g3r.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// The points of a solve, and what is known of each.
struct TileCloud {
  std::vector<Vec3> points;
  std::vector<std::uint64_t> index;      ///< in the input
  std::vector<std::uint8_t> own;         ///< 1: the tile solves for it
  std::vector<std::uint32_t> part;       ///< of ring 0, kNoPart beyond; see parts_of_ring()
  std::vector<double> relative_spacing;  ///< square root of the number of points that each one stands for
  std::vector<std::uint32_t> coarse;     ///< its place in the thinned cloud, kNotCoarse if it is not there
};
inline constexpr std::uint32_t kNotCoarse = 0xffffffffU;

/// Scans the sorted points for the cells of manifest.level and stores them. Throws IoError, Cancelled.
Cells find_cells(const std::string& folder, const Manifest& manifest, Stages& stages);

/// Number of points that read_tile_cloud() will find; `stride`: of the thinned cloud. O(cells).
[[nodiscard]] std::uint64_t count_tile_cloud(const Cells& cells, std::uint64_t stride, const Tile& tile);

/// Reads them. Throws IoError.
[[nodiscard]] TileCloud read_tile_cloud(const std::string& folder, const Manifest& manifest, const Cells& cells, const Tile& tile);

/// The monitor with `name` before the names of stages. It must outlive what is returned.
[[nodiscard]] Monitor named(const Monitor& monitor, const std::string& name);

}  // namespace g3r::tiles
