// The published formulation: min_eta sum_k |A[u_k] eta - u_k/2|^2, as its normal equations.
#pragma once

#include "solve/harmonics.h"
#include "solve/linear_system.h"
#include "sum/fast_sum.h"

#include <vector>

namespace g3r {

/// M = sum_k A[u_k]^T A[u_k], b = sum_k A[u_k]^T u_k / 2. Two sweeps per product, fused over k.
class GreenSystem : public LinearSystem {
 public:
  /// `sum` must outlive the system.
  GreenSystem(FastSum& sum, const std::vector<Vec3>& points, const std::vector<Harmonic>& harmonics);

  void apply(const std::vector<Vec3>& eta, std::vector<Vec3>& product) override;
  std::vector<Vec3> right_side() override;
  std::unique_ptr<SolveVectors> vectors_elsewhere() override { return sum_.green_vectors(u_); }

 private:
  FastSum& sum_;
  HarmonicValues u_;
};

}  // namespace g3r
