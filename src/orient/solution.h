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

/// Whether polish_projected() is for this problem: the projection halves the variance of the noise at least. Nothing is projected without
/// noise, on lines, by earlier methods and the paper's.
[[nodiscard]] bool is_projected(const Problem& problem);

/// Kernels that hide the noise hide thin walls too, and narrower ones fit the noise. But noise is seen across the surface, whose direction
/// is known up to its side: points are moved onto their wall (project_points()), and polished with kernels for the noise that this leaves
/// (after_projection()). More sides are right then, and more points are moved onto their own wall: up to three times, while 0.1 % of the
/// sides turn. Certifies the sides anew. Does so for the points whose sides come from the equations, of a problem that is_projected(), and
/// returns whether it did.
bool polish_projected(const Problem& problem, const Options& options, Stages& stages, Solution& solution);

/// The last word on the directions of a noisy cloud (fit_noisy_jets). Nothing happens without noise, and to earlier methods and the
/// paper's.
void fit_noisy_surface(const Problem& problem, Stages& stages, Solution& solution);

}  // namespace g3r
