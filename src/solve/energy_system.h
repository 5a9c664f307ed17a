// The same equations centred at every evaluation point (docs/math.md, "Centred form"): Stokes single layer, zero on the true normals.
#pragma once

#include "solve/linear_system.h"
#include "sum/fast_sum.h"

#include <vector>

namespace g3r {

/// min_eta 1/2 eta^T (S_e + d I) eta + l/2 |W eta - 1/2|^2, that is M = S_e + d I + l W^T W, b = l/2 W^T 1.
/// S_e is the Gaussian-regularised Stokes single layer, positive semidefinite for any e; its null space is the normal field of every
/// component, which W eta = 1/2 pins. Two sweeps per product, and M is not squared.
class EnergySystem : public LinearSystem {
 public:
  /// `damping` d >= 0, 1/length; `winding_weight` l > 0, length. `sum` must outlive the system.
  EnergySystem(FastSum& sum, double damping, double winding_weight) : sum_(sum), damping_(damping), winding_weight_(winding_weight) {}

  std::vector<Vec3> apply(const std::vector<Vec3>& eta) override;
  std::vector<Vec3> right_side() override;

 private:
  FastSum& sum_;
  double damping_;
  double winding_weight_;
};

}  // namespace g3r
