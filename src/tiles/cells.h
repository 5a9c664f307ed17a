// The cells of one level of the Morton grid that hold points, and what lies around a tile in them.
#pragma once

#include "cloud/morton.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::tiles {

/// An occupied cell. Its points follow one another in Morton order.
struct Cell {
  std::uint64_t code;   ///< Morton code of the cell at its level
  std::uint64_t begin;  ///< place of its first point in the order
};

/// All occupied cells of a level, ascending.
struct Cells {
  int level = 0;
  std::uint64_t points = 0;
  std::vector<Cell> cells;

  [[nodiscard]] std::uint64_t end(std::size_t cell) const { return cell + 1 < cells.size() ? cells[cell + 1].begin : points; }
};

/// Finds the deepest level, of 0 to kGridBits, whose occupied cells hold 64 points or more on average.
class LevelChoice {
 public:
  /// Takes note of the Morton code of a point; codes ascend.
  void add(std::uint64_t code);
  /// For the points so far; 0 without any.
  [[nodiscard]] int level() const;

 private:
  std::uint64_t last_ = 0;
  std::uint64_t points_ = 0;
  std::array<std::uint64_t, kGridBits + 1> occupied_{};
};

/// The ring of every cell around the tile of cells [first, last): 0 for its own and those next to them, r where that holds of the cells r
/// levels up, at most `outermost`. O(cells).
[[nodiscard]] std::vector<std::uint8_t> rings_around(const Cells& cells, std::size_t first, std::size_t last, int outermost);

/// The part of a cell outside of ring 0.
inline constexpr std::uint32_t kNoPart = 0xffffffffu;
/// Parts of ring 0: for every cell the number of its part, cells that touch being in one; kNoPart outside of the ring. O(cells log cells).
[[nodiscard]] std::vector<std::uint32_t> parts_of_ring(const Cells& cells, const std::vector<std::uint8_t>& rings);

}  // namespace g3r::tiles
