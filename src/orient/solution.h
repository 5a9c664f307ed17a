// From a problem to area vectors and normals.
#pragma once

#include "base/stages.h"
#include "orient/open_surfaces.h"
#include "orient/problem.h"
#include "solve/refine.h"

#include <g3r/g3r.h>

#include <vector>

namespace g3r {

/// Of every point in canonical order.
struct Solution {
  std::vector<Vec3> eta;  ///< area vectors
  Refinement refinement;  ///< normals, and the jump of the field they come from (empty without a refinement)
  OpenSurfaces open_surfaces;
};

/// Solves with the problem's method and settings, on the points or on clusters of them. Adds the iterations and whether they converged to
/// `stats`. Throws Cancelled.
[[nodiscard]] Solution solve(const Problem& problem, const Options& options, Stages& stages, Stats& stats);

/// An open surface makes the equations of everything beside it wrong too. So each one is solved for alone, which may show that it was none,
/// and then everything else without them, unless the others have no part in the equations: the mean size of their winding number at the
/// points is at most 0.02, of 1/2. Nothing happens without an open surface, or with one that is all there is.
void solve_open_surfaces_apart(const Problem& problem, const Options& options, Stages& stages, Stats& stats, Solution& solution);

/// The last word on the directions of a noisy cloud (fit_noisy_jets). Nothing happens without noise, and to earlier methods and the
/// paper's.
void fit_noisy_surface(const Problem& problem, Stages& stages, Solution& solution);

}  // namespace g3r
