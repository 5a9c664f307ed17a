// Places of a tile and what is near them.
#include "tiles/cell_codes.h"
#include "tiles/mesh_plan.h"

#include <algorithm>

namespace g3r::tiles {

std::size_t MeshFolder::owner(std::uint64_t code) const {
  return static_cast<std::size_t>(std::upper_bound(first_code.begin(), first_code.end(), code) - first_code.begin()) - 1;
}

Region::Region(const MeshFolder& folder, std::size_t tile)
    : cells_(folder.cells),
      level_(folder.cells.level),
      begin_(folder.first_code[tile]),
      end_(tile + 1 < folder.tiles() ? folder.first_code[tile + 1] : std::uint64_t{1} << (3 * folder.cells.level)) {}

bool Region::is_near(std::uint64_t code, int level, int reach) const {
  const int up = 3 * (level_ - level);
  const auto meets = [&](std::uint64_t other) { return other << up < end_ && (other + 1) << up > begin_; };
  return meets(code) || any_neighbour(code, level, reach, meets);
}

// Of the cells [first, last), all within the cell `code` of `level`.
void Region::mark(int level, std::uint64_t code, std::size_t first, std::size_t last, std::vector<std::uint8_t>& rings) const {
  if (first == last) return;
  const bool near = is_near(code, level, kAround);
  if (!near || level == level_) {
    const auto ring = static_cast<std::uint8_t>(near ? 0 : level_ - level + 1);
    std::fill(rings.begin() + static_cast<std::ptrdiff_t>(first), rings.begin() + static_cast<std::ptrdiff_t>(last), ring);
    return;
  }
  const int up = 3 * (level_ - level - 1);
  for (std::uint64_t child = code << 3; child < (code + 1) << 3; ++child) {
    const auto end = std::partition_point(cells_.cells.begin() + static_cast<std::ptrdiff_t>(first),
                                          cells_.cells.begin() + static_cast<std::ptrdiff_t>(last),
                                          [&](const Cell& cell) { return cell.code >> up <= child; });
    const auto next = static_cast<std::size_t>(end - cells_.cells.begin());
    mark(level + 1, child, first, next, rings);
    first = next;
  }
}

std::vector<std::uint8_t> Region::rings() const {
  std::vector<std::uint8_t> rings(cells_.cells.size());
  mark(0, 0, 0, rings.size(), rings);
  return rings;
}

std::uint64_t cell_at(const std::array<std::uint32_t, 3>& grid, int level) {
  const auto along = [&](std::uint32_t g) {
    return static_cast<std::uint64_t>(std::min(g >> (mesh::kMaxOctreeLevel - level), (std::uint32_t{1} << level) - 1));
  };
  return cell_code(along(grid[0]), along(grid[1]), along(grid[2]));
}

}  // namespace g3r::tiles
