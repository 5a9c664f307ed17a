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
///
/// That is for sides that are shown. Of unsure points (confidence below a half) a sensor is a witness, as scanners see fronts: one that all
/// sensors that may have seen it see from one side, at the cosine v nearest to edge-on, is turned where both_say(r, (1 + v) / 2) is below a
/// half, r the share of these votes in favour of the sides of all unsure points. What is two thirds and more of that chance and of
/// (1 + |v|) / 2 becomes its confidence.
///
/// Marks points in HintEffect::turned, and writes contradicted_share, closed_parts_turned and the confidence. O(N sensors), of which at
/// most 500 for the winding number. Throws Cancelled.
void judge_closed_parts(const HintedCloud& cloud, Voters& voters, HintEffect& effect, const std::atomic<bool>* cancel);

/// Indices in Hints::inside of the places about which the winding number of the closed parts, as `eta` says, is below 1/4. O(N) for each
/// place. Throws Cancelled.
[[nodiscard]] std::vector<std::size_t> inside_no_closed_part(const HintedCloud& cloud, const std::atomic<bool>* cancel);

}  // namespace g3r
