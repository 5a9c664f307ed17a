// The seam between a formulation of the orientation problem and the solvers: a symmetric positive semidefinite system M eta = b.
#pragma once

#include "sum/solve_vectors.h"

#include <g3r/points.h>

#include <memory>
#include <vector>

namespace g3r {

/// M and b. M is symmetric positive semidefinite up to the accuracy of its sums; eta, b are N vectors.
class LinearSystem {
 public:
  virtual ~LinearSystem() = default;
  /// M eta into `product`, another vector, whose memory is used again.
  virtual void apply(const std::vector<Vec3>& eta, std::vector<Vec3>& product) = 0;
  /// b
  virtual std::vector<Vec3> right_side() = 0;
  /// Vectors of a solve where the products are made, if that is not in memory: null if it is. The system must outlive them.
  virtual std::unique_ptr<SolveVectors> vectors_elsewhere() { return nullptr; }
};

/// M eta
[[nodiscard]] inline std::vector<Vec3> product_of(LinearSystem& system, const std::vector<Vec3>& eta) {
  std::vector<Vec3> product;
  system.apply(eta, product);
  return product;
}

}  // namespace g3r
