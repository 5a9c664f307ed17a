// The vectors of an iterative solve, and what it does with them: where they are is not the solver's concern.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

namespace g3r {

/// x, r = b - M x, the direction p, and M p or M x.
enum class SolveVector { kSolution, kResidual, kDirection, kProduct };
inline constexpr std::size_t kSolveVectors = 4;

/// N vectors each. All throw VectorsLost.
class SolveVectors {
 public:
  virtual ~SolveVectors() = default;
  virtual void set(SolveVector to, const std::vector<Vec3>& values) = 0;
  /// Its values, which it no longer has.
  [[nodiscard]] virtual std::vector<Vec3> take(SolveVector from) = 0;
  virtual void copy(SolveVector from, SolveVector to) = 0;
  /// a . b, added in a fixed order.
  [[nodiscard]] virtual double dot(SolveVector a, SolveVector b) = 0;
  /// y = scale y + factor x
  virtual void combine(SolveVector y, double scale, double factor, SolveVector x) = 0;
  /// product = M x, another vector.
  virtual void multiply(SolveVector x, SolveVector product) = 0;
};

/// What had the vectors failed, for a reason in one line; in memory the system goes on working.
class VectorsLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace g3r
