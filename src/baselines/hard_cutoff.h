// The winding field without any part from sources nearer than a width: the kernel of WNNC.
#pragma once

#include "baselines/near_pairs.h"
#include "sum/fast_sum.h"

#include <g3r/points.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Sums over sources at distance rho >= width only, with the plain kernels g = 1/(4 pi rho^3), b = 3 g/rho^2. FastSum mollifies by a
/// Gaussian instead; its kernels are the plain ones from 5 widths on (7 in double), so its sums of a fifth of the width, less the
/// mollified terms of the pairs within the width, are the wanted ones.
/// Cost of a sum: that of FastSum plus one table look-up per near pair, about pi (width/spacing)^2 per point. Not quick for wide cut-offs.
class HardCutoffSum {
 public:
  /// As FastSum; 0 < width in the unit of the points.
  HardCutoffSum(const std::vector<Vec3>& points, double width, const SumPlan& plan, const std::atomic<bool>* cancel);

  /// W eta: N values.
  std::vector<double> winding(const std::vector<Vec3>& eta);
  /// W^T q: N vectors, the adjoint of winding() to rounding.
  std::vector<Vec3> winding_adjoint(const std::vector<double>& q);
  /// -grad w at the points: N vectors.
  std::vector<Vec3> winding_gradient(const std::vector<Vec3>& eta);

 private:
  static constexpr std::size_t kIntervals = 4096;  // of (rho/width)^2; interpolation error below 1e-5 of a kernel's value

  struct Kernels {
    double g;
    double b;
  };
  [[nodiscard]] Kernels mollified(double squared_distance) const;
  template <class Use>
  void for_near(const Use& use) const;  // use(i, j, y_j - x_i, kernels)

  const std::vector<Vec3>& points_;
  double width_;
  FastSum sum_;
  NearPairs near_;
  std::array<Kernels, kIntervals + 2> table_{};
};

}  // namespace g3r
