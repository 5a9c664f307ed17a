// Sides of closed parts, by sensors inside them and places that the user calls inside.
#pragma once

#include "orient/hints.h"
#include "orient/votes.h"

#include <atomic>
#include <cstddef>
#include <vector>

namespace g3r {

/// Closed parts have one side, and no hint can choose it; but a room is a solid whose inside was scanned. They are turned by
/// `seen_from_inside` where they surround the sensors or reach through the cloud, and by sensors inside them, where the winding number of
/// `eta` is 1/4 and more (outside it is 0, however near or far), or, if the sensor of each point is known, by two thirds of the votes.
/// Marks their points in HintEffect::turned, and writes contradicted_share and closed_parts_turned. O(N) for each of at most 500 sensors.
/// Throws Cancelled.
void judge_closed_parts(const HintedCloud& cloud, Voters& voters, HintEffect& effect, const std::atomic<bool>* cancel);

/// Indices in Hints::inside of the places about which the winding number of the closed parts, as `eta` says, is below 1/4. O(N) for each
/// place. Throws Cancelled.
[[nodiscard]] std::vector<std::size_t> inside_no_closed_part(const HintedCloud& cloud, const std::atomic<bool>* cancel);

}  // namespace g3r
