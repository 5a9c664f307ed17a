// The seam between a formulation of the orientation problem and the solvers: a symmetric positive semidefinite system M eta = b.
#pragma once

#include <g3r/points.h>

#include <vector>

namespace g3r {

/// M and b. M is symmetric positive semidefinite up to the accuracy of its sums; eta, b are N vectors.
class LinearSystem {
 public:
  virtual ~LinearSystem() = default;
  /// M eta
  virtual std::vector<Vec3> apply(const std::vector<Vec3>& eta) = 0;
  /// b
  virtual std::vector<Vec3> right_side() = 0;
};

}  // namespace g3r
