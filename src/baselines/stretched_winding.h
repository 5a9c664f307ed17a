// The winding number of a cloud whose coordinates are stretched: the same number in the continuum, another equation for samples.
#pragma once

#include "sum/fast_sum.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r {

/// With S = diag(stretch)/max(stretch) and z = S y, areas transform by the cofactors C = det(S) S^-1, so that for z-kernels of width e'
///   (W_S eta)(x) = sum_i g_e'(|S r|) (S r) . C eta_i = det(S) sum_i g_e'(|S r|) r . eta_i,   e' = e det(S)^(1/3)
/// which is the Gauss formula of the anisotropic Laplacian div(S^-2 grad u). One winding sum of FastSum per product.
class StretchedWinding {
 public:
  /// Points in [-1, 1]^3 in canonical order; all components of `stretch` > 0.
  StretchedWinding(const std::vector<Vec3>& points, const Vec3& stretch, double epsilon, const SumPlan& plan,
                   const std::atomic<bool>* cancel);

  /// W_S eta: N values.
  std::vector<double> apply(const std::vector<Vec3>& eta);
  /// W_S^T q: N vectors.
  std::vector<Vec3> adjoint(const std::vector<double>& q);
  /// Squared norm of every row of W_S, from the sources within 8 widths: the rest adds less than 5 %. N values > 0.
  [[nodiscard]] std::vector<double> row_norms() const;

 private:
  Vec3 cofactors_;
  double epsilon_;
  const std::atomic<bool>* cancel_;
  std::vector<std::uint32_t> index_;                 // canonical index of the k-th point in the stretched order
  std::unique_ptr<const std::vector<Vec3>> points_;  // stretched, in that order; stay where they are, for the sum
  std::unique_ptr<FastSum> sum_;
};

}  // namespace g3r
