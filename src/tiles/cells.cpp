#include "tiles/cells.h"

#include "base/disjoint_sets.h"
#include "cloud/morton.h"
#include "tiles/cell_codes.h"

#include <algorithm>
#include <bit>

namespace g3r::tiles {
namespace {

// Points in a cell, on average, at least: 8 to 16 spacings across on a surface. Larger cells make halos wider than they need be.
constexpr std::uint64_t kCellPoints = 64;
// Width of a halo in cells: 8 to 16 spacings. Points beside a border err no more than elsewhere (docs/evidence/any_size.md), under noise
// too, where kernels are as wide as that; 2 are no more accurate for a third more work.
constexpr std::int64_t kHaloCells = 1;

void sort_unique(std::vector<std::uint64_t>& codes) {
  std::sort(codes.begin(), codes.end());
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
}

// Cells of the level `up` above that are near the tile's, ascending.
std::vector<std::uint64_t> near_cells(const Cells& cells, std::size_t first, std::size_t last, int up) {
  std::vector<std::uint64_t> own;
  for (std::size_t c = first; c < last; ++c) {
    const std::uint64_t code = cells.cells[c].code >> (3 * up);
    if (own.empty() || own.back() != code) own.push_back(code);
  }
  std::vector<std::uint64_t> near;
  for (const std::uint64_t code : own) {
    for_neighbours(code, cells.level - up, kHaloCells, [&](std::uint64_t other) { near.push_back(other); });
    if (near.size() > (std::size_t{1} << 20)) sort_unique(near);
  }
  sort_unique(near);
  return near;
}

}  // namespace

void LevelChoice::add(std::uint64_t code) {
  // Codes differ at every level from that of their first different bit on.
  int from = 0;
  if (points_ > 0) from = code == last_ ? kGridBits + 1 : (std::countl_zero(code ^ last_) - 1) / 3 + 1;  // the top bit of a code is unused
  for (int level = from; level <= kGridBits; ++level) ++occupied_[static_cast<std::size_t>(level)];
  last_ = code;
  ++points_;
}

int LevelChoice::level() const {
  int level = 0;
  while (level < kGridBits && occupied_[static_cast<std::size_t>(level) + 1] * kCellPoints <= points_) ++level;
  return level;
}

std::vector<std::uint8_t> rings_around(const Cells& cells, std::size_t first, std::size_t last, int outermost) {
  std::vector<std::uint8_t> rings(cells.cells.size(), static_cast<std::uint8_t>(outermost));
  for (int ring = std::min(outermost, cells.level + 1) - 1; ring >= 0; --ring) {
    const std::vector<std::uint64_t> near = near_cells(cells, first, last, ring);
    auto at = near.begin();
    for (std::size_t c = 0; c < cells.cells.size(); ++c) {  // both ascend
      const std::uint64_t code = cells.cells[c].code >> (3 * ring);
      while (at != near.end() && *at < code) ++at;
      if (at != near.end() && *at == code) rings[c] = static_cast<std::uint8_t>(ring);
    }
  }
  return rings;
}

std::vector<std::uint32_t> parts_of_ring(const Cells& cells, const std::vector<std::uint8_t>& rings) {
  std::vector<std::uint64_t> codes;
  for (std::size_t c = 0; c < rings.size(); ++c) {
    if (rings[c] == 0) codes.push_back(cells.cells[c].code);
  }
  DisjointSets sets(codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    for_neighbours(codes[i], cells.level, 1, [&](std::uint64_t other) {
      const auto found = std::lower_bound(codes.begin(), codes.end(), other);
      if (found != codes.end() && *found == other) sets.join(i, static_cast<std::size_t>(found - codes.begin()));
    });
  }
  std::vector<std::uint32_t> parts(rings.size(), kNoPart);
  std::size_t i = 0;
  for (std::size_t c = 0; c < rings.size(); ++c) {
    if (rings[c] == 0) parts[c] = static_cast<std::uint32_t>(sets.find(i++));
  }
  return parts;
}

}  // namespace g3r::tiles
