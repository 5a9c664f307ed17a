// A better start makes a better solve: from the refined normals, a few steps of conjugate gradients, and a narrower refinement.
#pragma once

#include "base/stages.h"
#include "orient/settings.h"
#include "solve/refine.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// `width` at settings.spacing and in proportion to the local `spacing` elsewhere; the same everywhere if that is empty.
[[nodiscard]] Widths local_widths(double width, const Settings& settings, const std::vector<double>& spacing);

/// The square of `spacing` at every point; if that is empty, that of settings.spacing for all, times `multiplicity` unless that is empty
/// too.
[[nodiscard]] std::vector<double> point_areas(const Settings& settings, const std::vector<double>& spacing,
                                              const std::vector<double>& multiplicity);

/// Area vectors from a winding gradient: directions kept, lengths linear up to the median and constant beyond, so that thin parts whose
/// sides the gradient cannot distinguish start near zero and not on the wrong side; times `areas`, what one point stands for (one for
/// each, or one for all). One factor makes the median of W eta 1/2, what it is on the true surface; it is bounded to [1/3, 3], because an
/// open surface has no inside. One sweep of `sum`.
void gradient_to_areas(FastSum& sum, const std::vector<double>& areas, std::vector<Vec3>& gradient);

struct Polished {
  std::vector<Vec3> eta;
  Refinement refinement;
};

/// settings.polish_steps of conjugate gradients on the energy form at settings.polish_epsilon, started from `refined`, and the refinement
/// at settings.polish_width. The start has the right areas, which the first solve does not (its eta are 0.6 to 1.3 of them), so a few
/// steps suffice. Once: a second round rounds edges. This step is ours, not the paper's. Measured:
/// docs/evidence/formulation.md.
/// `spacing`: smoothed_spacing(); both widths follow it, in proportion to settings.spacing. Or empty: the same widths everywhere.
/// `multiplicity`: how many points each one stands for (empty: ones), which `spacing` shows too where it is given.
[[nodiscard]] Polished polish(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Settings& settings,
                              const std::vector<double>& spacing, const std::vector<double>& multiplicity, const Refinement& refined,
                              Stages& stages);

}  // namespace g3r
