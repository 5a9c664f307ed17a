// The sums by their definitions: plain double loops over all pairs. O(N Q) time; ground truth for tests, never used on large inputs.
// Formulas and signs: docs/math.md. All arrays are in the same order as the points; sources y_i carry eta_i or q_i, targets x.
#pragma once

#include "sum/harmonic_values.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <vector>

namespace g3r {

/// Mollifier widths: one value for all points, or one per point (pairs use pair_width_squared).
struct Widths {
  std::vector<double> values;
  explicit Widths(double uniform) : values{uniform} {}
  explicit Widths(std::vector<double> per_point) : values(std::move(per_point)) {}
  [[nodiscard]] bool uniform() const { return values.size() == 1; }
  [[nodiscard]] double operator[](std::size_t i) const { return uniform() ? values[0] : values[i]; }
};

namespace direct_sum {

/// (A[u_k] eta)(x_j) = sum_i [Phi_e grad u_k(y_i) + u_k(y_i) g_e r] . eta_i, N x K row-major. Paper eq. of section 3.
[[nodiscard]] std::vector<double> green(const std::vector<Vec3>& points, const Widths& widths, const HarmonicValues& u,
                                        const std::vector<Vec3>& eta);
/// Its adjoint: sum_k A[u_k]^T q_k, q is N x K row-major; N vectors.
[[nodiscard]] std::vector<Vec3> green_adjoint(const std::vector<Vec3>& points, const Widths& widths, const HarmonicValues& u,
                                              const std::vector<double>& q);
/// (S_e eta)(x) = sum_i [(Phi_e + e^2 g_e) eta_i + h_e r (r . eta_i)], the Gaussian-regularised Stokes single layer (times 2). N vectors.
[[nodiscard]] std::vector<Vec3> stokes_single_layer(const std::vector<Vec3>& points, const Widths& widths, const std::vector<Vec3>& eta);
/// w(x) = sum_i g_e (y_i - x) . eta_i at any targets (uniform width). Q values.
[[nodiscard]] std::vector<double> winding(const std::vector<Vec3>& points, double width, const std::vector<Vec3>& eta,
                                          const std::vector<Vec3>& targets, const std::atomic<bool>* cancel = nullptr);
/// -grad w(x) = sum_i [g_e eta_i - b_e r (r . eta_i)] at any targets (uniform width). Q vectors.
[[nodiscard]] std::vector<Vec3> winding_gradient(const std::vector<Vec3>& points, double width, const std::vector<Vec3>& eta,
                                                 const std::vector<Vec3>& targets, const std::atomic<bool>* cancel = nullptr);

}  // namespace direct_sum
}  // namespace g3r
