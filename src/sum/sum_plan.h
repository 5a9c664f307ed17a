// How a requested accuracy becomes an expansion order, an opening and a precision; and what memory a sum needs.
#pragma once

#include <cstddef>
#include <memory>

namespace g3r {

namespace gpu {
class Execution;
}

/// Parameters of the hierarchical sums. Measured by bench/fast_sum over clouds of every kind; see docs/algorithms/fast_sums.md.
struct SumPlan {
  bool direct = false;  ///< every pair point by point
  bool double_precision = false;
  int order = 4;            ///< of the expansions
  double opening = 0.5;     ///< far when radius_t + radius_s <= opening * distance
  double cut = 4;           ///< entries of M2L below this times the first term that the order truncates are dropped, see kept_degrees()
  double reach = 5;         ///< mollifier widths between far nodes, at least; beyond, the far field's plain kernels are good enough
  double kernel_error = 0;  ///< relative error that the kernel of a near pair may have; rounding otherwise
  std::size_t leaf_points = 64;  ///< largest leaf
  /// The device that sums run on; null: that of the gpu::Scope, or the processor.
  std::shared_ptr<gpu::Execution> execution = nullptr;
};

/// The cheapest plan whose relative l2 error stays below `accuracy` in [1e-6, 1e-1], for N points. accuracy 0, or N below the measured
/// crossover: direct. Throws InvalidInput outside that range.
[[nodiscard]] SumPlan sum_plan(double accuracy, std::size_t points);

}  // namespace g3r
