// Normals of the outliers, which take no part in the solve.
#pragma once

#include "base/stages.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <vector>

namespace g3r {

/// Appends the outliers of the problem to its solution and to the confidence of its points: their normals follow the winding field of the
/// area vectors, against its gradient, they have no area, and deserve no confidence. To be called when the area vectors are those that are
/// returned. O(N + outliers log N). Throws Cancelled.
void add_outliers(const Problem& problem, Stages& stages, Solution& solution, std::vector<float>& confidence);

}  // namespace g3r
