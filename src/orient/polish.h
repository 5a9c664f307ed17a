// A better start makes a better solve: from the refined normals, a few steps of conjugate gradients, and a narrower refinement.
#pragma once

#include "base/stages.h"
#include "orient/settings.h"
#include "solve/refine.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// The values times `factor`.
inline std::vector<double> scaled(double factor, std::vector<double> values) {
  for (double& v : values) v *= factor;
  return values;
}

/// `width` at the local `spacing`; in proportion to it where points crowd, under noise too; the typical one everywhere if that is empty.
[[nodiscard]] Widths local_widths(const KernelWidth& width, const Settings& settings, const std::vector<double>& spacing);

/// The square of `spacing` at every point, or one value for all, that of settings.spacing, if it is empty.
[[nodiscard]] std::vector<double> point_areas(const Settings& settings, const std::vector<double>& spacing);

/// Area vectors from a winding gradient: directions kept, lengths linear up to the median and constant beyond, so that thin parts whose
/// sides the gradient cannot distinguish start near zero and not on the wrong side; times `areas`, what one point stands for (one for
/// each, or one for all). One factor makes the median of W eta 1/2, what it is on the true surface; it is 1 where W eta is only
/// rounding, as on a flat surface. One sweep of `sum`.
void gradient_to_areas(FastSum& sum, const std::vector<double>& areas, std::vector<Vec3>& gradient);

/// What polish() gives.
struct Polished {
  std::vector<Vec3> eta;  ///< N area vectors, as solved
  Refinement refinement;  ///< their winding gradient
};

/// The points of a polish, in canonical order.
struct PolishCloud {
  const std::vector<Vec3>& points;
  std::vector<double> spacing;  ///< at each point, which both widths follow; empty: the typical one everywhere
  std::vector<double> areas;    ///< that each point stands for, or one for all
  std::vector<double> roots;    ///< of how much the equations of each point count; empty: ones
};

/// settings.polish.steps of conjugate gradients on the energy form at settings.polish.epsilon, started from `refined`, and the refinement
/// at settings.polish.width. The start has the right areas, which the first solve does not (its eta are 0.6 to 1.3 of them), so a few
/// steps suffice. Once: a second round rounds edges. This step is ours, not the paper's. Measured: docs/evidence/formulation.md. O(N) a
/// step. Throws Cancelled.
[[nodiscard]] Polished polish(PolishCloud cloud, const Settings& settings, Refinement refined, Stages& stages);

}  // namespace g3r
