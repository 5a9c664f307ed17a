// The equations of some points, those of the others being held. docs/math.md, "Around unsure signs".
#pragma once

#include "solve/iterative_solver.h"
#include "solve/linear_system.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace g3r {

/// The values of some.
template <class T>
std::vector<T> values_at(const std::vector<std::uint32_t>& some, const std::vector<T>& values) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(some.size());
  for (const std::uint32_t i : some) out.push_back(values[i]);
  return out;
}

/// (b - M x)_F and |b|.
struct PartResidual {
  std::vector<Vec3> residual;  ///< of every point of F
  double size = 0;             ///< of the right side of all points
};

/// Of `system`, that of all points, at x; `some`: F, ascending. One product.
[[nodiscard]] PartResidual residual_at(const std::vector<std::uint32_t>& some, LinearSystem& system, const std::vector<Vec3>& x);

/// M_FF d = (b - M x)_F for the change d, which is result.eta; `part` has M_FF: the matrix of F as a cloud of its own. Tolerance and
/// residuals are of F, relative to |b|. One product of F a step.
[[nodiscard]] IterativeResult solve_for_part(LinearSystem& part, const PartResidual& right, const std::vector<Steps>& schedule,
                                             double tolerance, const std::function<void(int, int, double)>& after_step);

}  // namespace g3r
