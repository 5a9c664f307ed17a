// Problems of generated clouds, for the tests of what is done with them.
#pragma once

#include "base/stages.h"
#include "base/vector.h"
#include "orient/problem.h"
#include "orient/solution.h"

#include <g3r/g3r.h>

#include <utility>
#include <vector>

namespace g3r::problems {

inline Problem prepared(const std::vector<Vec3>& points, const Options& options = {}, Known known = {}) {
  const Monitor monitor;
  Stages stages(monitor);
  return prepare(points, std::move(known), options, stages);
}

/// Values of the caller's points, which are finite and distinct, in the order of the problem's, without those of its outliers.
template <class T>
std::vector<T> in_its_order(const Problem& problem, const std::vector<T>& values) {
  std::vector<T> out(problem.cloud.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (problem.cloud.point_of[i] < out.size()) out[problem.cloud.point_of[i]] = values[i];
  }
  return out;
}

/// What the equations find of points with these normals, of the caller's points, if they find all of it: the areas, and the same jump
/// everywhere.
inline Solution solution_of(const Problem& problem, const std::vector<Vec3>& normals) {
  Solution solution;
  solution.refinement.normals = in_its_order(problem, normals);
  solution.refinement.strength.assign(problem.cloud.size(), 1);
  for (std::size_t i = 0; i < problem.cloud.size(); ++i) {
    const double spacing = problem.cloud.set.smoothed_spacing()[i];
    solution.eta.push_back(vector::scale(solution.refinement.normals[i], spacing * spacing));
  }
  return solution;
}

}  // namespace g3r::problems
