// The first reading of the inputs of a plan: how many points there are, and where.
#pragma once

#include "base/stages.h"
#include "tiles/manifest.h"

#include <cstdint>
#include <string>
#include <vector>

namespace g3r::tiles {

/// Points of a plan, at least: fewer are solved in core in a second, and leave no thinned cloud worth the name.
inline constexpr std::uint64_t kFewestPoints = 8000;

/// The inputs and their points, those that are not finite among them, their bounds and their frame, and what the readers warn of. The rest
/// of the manifest is as it is by default. Throws like read_cloud(); InvalidInput for fewer than kFewestPoints, for a file without a finite
/// point, for coordinates that are too large and for points at one place; Cancelled.
[[nodiscard]] Manifest survey(const std::vector<std::string>& files, int threads, Stages& stages);

}  // namespace g3r::tiles
