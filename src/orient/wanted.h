// The points of a cloud whose normals are asked for; the others are their surroundings.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// The share of the wanted points for which is_so(i). `wanted`: 1 for each of `points` that is; where none is, or it is empty, all are.
/// O(N).
template <class IsSo>
[[nodiscard]] double share_of_wanted(const std::vector<std::uint8_t>& wanted, std::size_t points, const IsSo& is_so) {
  const bool all = std::none_of(wanted.begin(), wanted.end(), [](std::uint8_t w) { return w != 0; });
  std::size_t count = 0;
  std::size_t so = 0;
  for (std::size_t i = 0; i < points; ++i) {
    if (!all && wanted[i] == 0) continue;
    ++count;
    so += is_so(i) ? 1 : 0;
  }
  return static_cast<double>(so) / static_cast<double>(count);
}

}  // namespace g3r
