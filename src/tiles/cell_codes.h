// Arithmetic on the Morton codes of the cells of one level.
#pragma once

#include "cloud/morton.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace g3r::tiles {

/// One axis of a code: undoes spread_bits().
[[nodiscard]] inline std::int64_t gather_bits(std::uint64_t v) {
  v &= 0x1249249249249249ULL;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ULL;
  v = (v | v >> 4) & 0x100f00f00f00f00fULL;
  v = (v | v >> 8) & 0x1f0000ff0000ffULL;
  v = (v | v >> 16) & 0x1f00000000ffffULL;
  return static_cast<std::int64_t>((v | v >> 32) & 0x1fffff);
}

/// The code of a cell by its place along each axis.
[[nodiscard]] inline std::uint64_t cell_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
}

/// Whether test(code) holds of a cell of `level` at most `reach` away from one, itself included. Asks no more once it does.
template <class Test>
bool any_neighbour(std::uint64_t code, int level, std::int64_t reach, const Test& test) {
  const std::int64_t side = std::int64_t{1} << level;
  const std::array<std::int64_t, 3> at{gather_bits(code >> 2), gather_bits(code >> 1), gather_bits(code)};
  std::array<std::int64_t, 3> low{};
  std::array<std::int64_t, 3> high{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max<std::int64_t>(0, at[a] - reach);
    high[a] = std::min(side - 1, at[a] + reach);
  }
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        if (test(cell_code(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(z)))) return true;
      }
    }
  }
  return false;
}

/// Calls visit(code) for the cells of `level` at most `reach` away from one, itself included.
template <class Visit>
void for_neighbours(std::uint64_t code, int level, std::int64_t reach, const Visit& visit) {
  (void)any_neighbour(code, level, reach, [&](std::uint64_t other) {
    visit(other);
    return false;
  });
}

}  // namespace g3r::tiles
