#include "orient/restless.h"

#include "cloud/constants.h"
#include "cloud/sites.h"
#include "orient/certified_sides.h"
#include "orient/two_walls.h"

#include <algorithm>
#include <cstddef>

namespace g3r {

std::vector<std::uint32_t> restless_pieces(const SiteParts& parts, std::uint32_t part, const std::vector<double>& unrest, double noise) {
  const std::vector<std::uint32_t>& members = parts.members(part);
  const std::size_t count = std::min(kSmallPart, members.size() / kFewestSites);
  std::vector<std::uint32_t> restless;
  for (std::size_t k = 0; k < count; ++k) {
    const auto start = [&](std::size_t piece) { return members.begin() + static_cast<std::ptrdiff_t>(piece * members.size() / count); };
    const std::vector<std::uint32_t> piece(start(k), start(k + 1));
    if (mean_over(piece, unrest) <= kUnrest) continue;
    if (on_two_walls(parts.set(), parts.sites(), piece, noise, unrest)) continue;
    restless.insert(restless.end(), piece.begin(), piece.end());
  }
  return restless;
}

}  // namespace g3r
