// Conjugate gradients started from the solution on fewer points.
#pragma once

#include "base/stages.h"
#include "orient/settings.h"
#include "solve/iterative_solver.h"
#include "solve/refine.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Area vectors, and their refinement at settings.refinement_width (empty if that is 0).
struct Solved {
  IterativeResult result;
  Refinement refinement;
};

/// Solves settings.method on N points in canonical order. With settings.coarse_to_fine and enough points, every 4th point is solved first
/// (recursively, all lengths doubled), and the start is that solution's winding gradient as area vectors (gradient_to_areas()).
/// The smooth part of the error, which conjugate gradients reduce slowest, is gone from the start, so the tolerances of starts and of
/// continued solves are wider. Measured: docs/evidence/formulation.md.
/// Where the sides of many points are unsure in the end (thin walls, narrow gaps), more steps are tried, wider and with more weight on the
/// winding number, which turns parts that are wrong as a whole; not where most points lie on open surfaces (find_open_surfaces()), of which
/// the equations are not true. They are undone if more points are unsure then; not under noise, of which every step makes more of
/// them unsure, right or wrong.
/// `gradient`, `relative_spacing`: what is known of these points (Known), or empty. The gradient takes the place of that winding gradient.
/// All kernels of the finest level are as much wider where points are farther apart by the relative spacing, and the unknowns and equations
/// there count as those of the points that they stand for (EnergySystem): a sparse part weighs as much as a dense one of the same area. In
/// kernels of one width single points of sparse parts are far apart, and their equations say little (docs/evidence/other_inputs.md). The
/// returned residuals are those of the finest level. Begins the stage "refine" after the solve. Throws like solve_iteratively().
[[nodiscard]] Solved solve_coarse_to_fine(const std::vector<Vec3>& points, const Settings& settings, Stages& stages,
                                          const std::vector<double>& relative_spacing = {}, const std::vector<Vec3>& gradient = {});

}  // namespace g3r
