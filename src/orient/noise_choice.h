// Which noise the kernels are made for, where the estimate leaves many sides unsure.
#pragma once

#include "base/stages.h"
#include "orient/attempt.h"

#include <g3r/g3r.h>

#include <vector>

namespace g3r {

/// A noise to try instead of the estimate.
struct OtherNoise {
  double noise = 0;                  ///< standard deviation, in the unit frame; 0: none
  double most_doubt = kClearlyLess;  ///< of the doubt with the estimate, up to which it is taken
};

/// What to try, in this order, where the sides of many points are unsure; nothing elsewhere. No noise: few points on much shape look noisy,
/// but not rounded. More: what scatters most, of noise that differs from place to place and of scans that do not fit onto each other, looks
/// like shape beside what scatters least, which the estimate goes by; what rounding leaves, where exact terraces hide it; and noise of a
/// spacing or so can turn whole shells, in cavities for example, in the narrow polish. A surface that is open at the estimate may be closed
/// at such a scatter, but not at one that kernels hide anyway. `found`: the solution of the problem. O(N log N).
[[nodiscard]] std::vector<OtherNoise> other_noises(const Problem& problem, const Oriented& found);

/// The attempt with the best noise, `first` being that with the estimate: narrower kernels where these separate walls (separate_walls()),
/// then the other_noises() that leave clearly less doubt: less than the estimate where walls explain the doubt, more else, also where
/// narrower kernels have left it. Thin walls and layers of scans that do not fit onto each other look alike from near. But few sides of
/// walls are unsure when they are solved for as what they are, of layers when they are solved for as noise. More noise may also make one
/// surface of thin walls, of which all sides are sure: it is not taken where points then lie about that surface as about two. Nothing else
/// is tried where noise or kernels are given, sides are known, the samples are lines, by earlier methods and the paper's, and without
/// Step::kNoise or Step::kNoiseChoice. `points`, `options`: of `first`. Throws Cancelled.
[[nodiscard]] Attempt with_best_noise(Attempt first, const PointsView& points, const Options& options, Stages& stages);

}  // namespace g3r
