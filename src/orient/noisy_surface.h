// The sides and directions of noisy points, from their own walls.
#pragma once

#include "base/stages.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

namespace g3r {

/// Whether polish_projected() is for this problem: the projection halves the variance of the noise at least. Nothing is projected without
/// noise, on lines, by earlier methods and the paper's.
[[nodiscard]] bool is_projected(const Problem& problem);

/// Kernels that hide the noise hide thin walls too, and narrower ones fit the noise. But noise is seen across the surface, whose direction
/// is known up to its side: points are moved onto their wall (project_points()), and polished with kernels for the noise that this leaves
/// (after_projection()). More sides are right then, and more points are moved onto their own wall: up to three times, while 0.1 % of the
/// sides turn. Certifies the sides anew. Does so for the points whose sides come from the equations, of a problem that is_projected(), and
/// returns whether it did.
bool polish_projected(const Problem& problem, const Options& options, Stages& stages, Solution& solution);

/// The final directions of a noisy cloud: those of fit_noisy_jets(), and of planes where facets scatter by all of the noise. Nothing
/// happens without noise, and to earlier methods and the paper's. O(N). Throws Cancelled.
void fit_noisy_surface(const Problem& problem, Stages& stages, Solution& solution);

}  // namespace g3r
