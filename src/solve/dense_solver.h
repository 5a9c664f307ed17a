// The published small-N path: assemble the normal matrix and factor it.
#pragma once

#include "solve/harmonics.h"
#include "sum/direct_sum.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// The most points of the dense solver: their 3N x 3N doubles take 1.2 GB, and more grow with N^2, the time with N^3.
inline constexpr std::size_t kMostDensePoints = 4000;

struct DenseResult {
  std::vector<Vec3> eta;        ///< empty: the matrix is singular to rounding
  double condition_number = 0;  ///< of the normal matrix; 0 unless asked for
};

/// Rows of A: for point j and harmonic k the 3N coefficients of eta, N K x 3N row-major, in double from the definitions.
[[nodiscard]] std::vector<double> assemble_rows(const std::vector<Vec3>& points, double epsilon, const HarmonicValues& u,
                                                std::size_t first_point, std::size_t last_point);

/// argmin sum_k |A[u_k] eta - u_k/2|^2 by Cholesky of the normal matrix, which is singular where there are too few harmonics (K = 1 is rank
/// deficient) or points are much closer together than epsilon. O(N^3) time, 9 N^2 doubles, and as many again for the condition number,
/// whose steps, of O(N^3) on one core, cannot be cancelled: minutes at most. Throws InvalidInput for more than kMostDensePoints points,
/// Cancelled.
[[nodiscard]] DenseResult solve_dense(const std::vector<Vec3>& points, double epsilon, const HarmonicValues& u, bool condition_number,
                                      const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
