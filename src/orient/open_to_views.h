// Sides of what sensors have seen from known places.
#pragma once

#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// A sensor sees the front of every point, whether the surface has an inside or not: what the equations took for closed parts, most often
/// thick noise, is treated as one open surface, and its points are turned to face their sensors. Where n . v is 0, v the direction from the
/// point to its sensor, the side is a choice: it is certified to (1 + |n . v|) / 2. What it turns is marked in Solution::turned_to_views.
/// O(N).
void open_to_views(const Views& views, const std::vector<Vec3>& points, Solution& solution);

/// Whether solve_by_sight() is for this problem: its points have been seen from known places, with more noise than the equations' own
/// kernels hide.
[[nodiscard]] bool is_seen_in_noise(const Problem& problem);

/// Where sides are known and noise hides the directions, the equations have nothing to add: directions come from the lines of sight
/// (normals_by_sight()), and everything is one open surface that faces its sensors.
[[nodiscard]] Solution solve_by_sight(const Problem& problem, Stages& stages, Stats& stats);

}  // namespace g3r
