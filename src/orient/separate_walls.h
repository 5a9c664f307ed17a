// Narrower kernels, where those that hide the noise take two walls for one.
#pragma once

#include "base/stages.h"
#include "orient/attempt.h"

#include <g3r/g3r.h>

namespace g3r {

/// The noise that the kernels of the next try hide, after those that hide this one: kernels follow the square of the noise, and become
/// narrower by sqrt(2). Any unit.
[[nodiscard]] double next_hidden_noise(double noise);

/// Kernels that hide the noise take walls closer together than they are wide for one: then points lie farther from the surface that is
/// found than noise carries them (misfit()), or lie about it as about two (MeanExcess::is_two_walls()). Where that is so, narrower kernels
/// are tried until it is not (the discrepancy principle of Morozov, "On the solution of functional equations by the method of
/// regularization", 1966), or until they are as narrow as those of clean clouds. If points come to lie farther away again before, it was
/// shape, creases for example, and the first ones stay. Half of the points of merged walls face the wrong way and turn when the walls are
/// separated: where fewer do than half of a doubtful share, and there is as much doubt as before, points far from the surface have another
/// cause, such as noise that was estimated too low, and narrower kernels only fit the noise. Returns the attempt with the kernels that are
/// taken; its statistics have the noise of the points, not what kernels hide. Clean and open clouds have no such walls, and those without
/// doubt (kDoubtful) are not asked. `points`, `options`: of `found`. Throws Cancelled.
[[nodiscard]] Attempt separate_walls(Attempt found, const PointsView& points, const Options& options, Stages& stages);

}  // namespace g3r
