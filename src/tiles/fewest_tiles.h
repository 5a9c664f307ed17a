// The number of tiles that a limit of memory asks for.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace g3r::tiles {

/// Cuts into `first` tiles and then a quarter more each time (smaller steps count surroundings more often, larger ones overshoot), until
/// cut(count), which returns the bytes that the largest tile takes with its surroundings, is at most `limit`. False where that cannot be:
/// there are no more tiles than cells, and where more than 64 tiles leave the largest as it was all of it is surroundings; with fewer that
/// may be chance.
template <class Cut>
[[nodiscard]] bool cut_into_fewest(std::size_t first, std::size_t cells, std::uint64_t limit, const Cut& cut) {
  constexpr std::size_t kSurelyStuck = 64;
  std::uint64_t before = 0;
  for (std::size_t count = first;; count += count / 4 + 1) {
    const std::uint64_t largest = cut(std::min(count, cells));
    if (largest <= limit) return true;
    if (count >= cells || (count > kSurelyStuck && largest == before)) return false;
    before = largest;
  }
}

}  // namespace g3r::tiles
