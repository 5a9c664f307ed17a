// The same equations centred at every evaluation point (docs/math.md, "Centred form"): Stokes single layer, zero on the true normals.
#pragma once

#include "solve/linear_system.h"
#include "sum/fast_sum.h"

#include <vector>

namespace g3r {

/// min_eta 1/2 eta^T (S_e + d I) eta + l/2 |W eta - 1/2|^2, that is M = S_e + d I + l W^T W, b = l/2 W^T 1.
/// S_e is the Gaussian-regularised Stokes single layer, positive semidefinite for any e; its null space is the normal field of every
/// component, which W eta = 1/2 pins. Two sweeps per product, and M is not squared.
/// With multiplicities m_i, point i stands for m_i points that share their area vector: the unknown is x = D^-1 eta, D = diag sqrt(m), and
/// M = D (S_e + l W^T D^2 W) D + d I, what the system of all points becomes on vectors that are constant on each group.
class EnergySystem : public LinearSystem {
 public:
  /// `damping` d >= 0, 1/length; `winding_weight` l > 0, cubed length. `roots`: sqrt(m_i) >= 1 of every point, or empty for ones; it and
  /// `sum` must outlive the system.
  EnergySystem(FastSum& sum, double damping, double winding_weight, const std::vector<double>& roots);
  EnergySystem(FastSum& sum, double damping, double winding_weight);
  EnergySystem(FastSum&, double, double, std::vector<double>&&) = delete;

  void apply(const std::vector<Vec3>& x, std::vector<Vec3>& product) override;
  std::vector<Vec3> right_side() override;
  std::unique_ptr<SolveVectors> vectors_elsewhere() override { return sum_.energy_vectors(damping_, winding_weight_, root_); }

  /// eta = D x and x = D^-1 eta
  [[nodiscard]] std::vector<Vec3> to_areas(std::vector<Vec3> x) const;
  [[nodiscard]] std::vector<Vec3> from_areas(std::vector<Vec3> eta) const;

 private:
  // The rows of W: w_i *= m_i.
  void weight(std::vector<double>& w) const;

  FastSum& sum_;
  double damping_;
  double winding_weight_;
  const std::vector<double>& root_;  // sqrt(m), or empty
  std::vector<double> w_;            // of the product at hand, whose memory is used again
};

}  // namespace g3r
