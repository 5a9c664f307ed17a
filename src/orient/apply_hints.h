// The caller's hints, brought to the problem's points.
#pragma once

#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

#include <atomic>
#include <vector>

namespace g3r {

/// Follows options.hints (follow_hints), if there are any: turns normals and area vectors of the solution, gives decided points the
/// confidence of their votes, and brings `stats` up to date, with warnings where hints and points contradict each other; the result is not
/// consistent where most votes on closed parts do, nor where other points hide more than a tenth from the sensors. Also says where a side
/// is still a choice. To be called when normals and area vectors are those that are returned. Throws Cancelled.
void apply_hints(const Problem& problem, const Options& options, Solution& solution, std::vector<float>& confidence, Stats& stats,
                 const std::atomic<bool>* cancel);

}  // namespace g3r
