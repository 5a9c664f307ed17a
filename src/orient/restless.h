// Where the field of a part of a cloud is not that of a closed surface, though it is on the whole.
#pragma once

#include "orient/site_parts.h"

#include <cstdint>
#include <vector>

namespace g3r {

/// The sites of those pieces of a part whose mean unrest is above kUnrest, and which do not have two walls for a reason (on_two_walls()),
/// ascending. An object that stands on a table encloses most of what it and the table are, and its field is at rest inside; that of the
/// table is not. Pieces are 16 at most (kSmallPart), of as many sites each and of 30 at least; they are compact, for sites follow each
/// other in Morton order. `unrest`: of all sites (Certificate::unrest); `noise`: standard deviation, unit of the points. O(N log N).
[[nodiscard]] std::vector<std::uint32_t> restless_pieces(const SiteParts& parts, std::uint32_t part, const std::vector<double>& unrest,
                                                         double noise);

}  // namespace g3r
