// Steepest descent and conjugate gradients on M eta = b, from eta = 0 or a start, without restarts.
#pragma once

#include "solve/linear_system.h"

#include <g3r/points.h>

#include <functional>
#include <string>
#include <vector>

namespace g3r {

enum class StepKind { kSteepestDescent, kConjugateGradient };

/// A run of equal steps; a schedule is a list of them.
struct Steps {
  int count;
  StepKind kind;
};

/// Parses "20 sd 60 cg". Counts 0..100000. Throws InvalidInput.
[[nodiscard]] std::vector<Steps> parse_schedule(const std::string& text);

struct IterativeResult {
  std::vector<Vec3> eta;
  std::vector<StepKind> kinds;    ///< per step done
  std::vector<double> residuals;  ///< |b - M eta| / |b| after each step, by recurrence
  bool converged = false;         ///< the tolerance was reached
};

/// Follows the schedule until the relative residual falls to `tolerance` (0: never stop early).
/// `start`: eta to begin with, or empty for 0. `after_step(step, steps, residual)` may throw to stop.
/// Sources: Hestenes and Stiefel 1952. One product with M per step; reductions in fixed order. The vectors are where the products are made;
/// should they be lost there, all steps are done again, with vectors in memory.
[[nodiscard]] IterativeResult solve_iteratively(LinearSystem& system, const std::vector<Steps>& schedule, double tolerance,
                                                std::vector<Vec3> start = {}, const std::function<void(int, int, double)>& after_step = {});

}  // namespace g3r
