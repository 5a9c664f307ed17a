// From a problem to area vectors and normals.
#pragma once

#include "base/stages.h"
#include "orient/open_surfaces.h"
#include "orient/problem.h"
#include "solve/refine.h"

#include <g3r/g3r.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Of every point in canonical order.
struct Solution {
  std::vector<Vec3> eta;  ///< area vectors
  Refinement refinement;  ///< normals, and the jump of the field they come from (empty without a refinement)
  OpenSurfaces open_surfaces;
  std::vector<std::uint8_t> turned_to_views{};  ///< N: 1 where open_to_views() has turned a side; empty: nowhere
};

/// Solves for all points of a problem together, with its method and settings, on the points or on clusters of them. Adds the iterations and
/// whether they converged to `stats`. Points on open surfaces get area vectors along the normals found for them. Throws Cancelled.
[[nodiscard]] Solution solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats);

}  // namespace g3r
