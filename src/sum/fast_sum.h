// The sums of g3r over one cloud, in linear time with bounded error, or directly. docs/math.md, docs/algorithms/fast_sums.md.
#pragma once

#include "sum/direct_sum.h"
#include "sum/harmonic_values.h"
#include "sum/solve_vectors.h"
#include "sum/sum_plan.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r {

/// All sums over a cloud of N points in canonical order (cloud/canonical_cloud.h). Each is linear, and each adjoint is the adjoint of its
/// forward sum to rounding (1e-6 in float plans, 1e-12 in double plans): same tree, same lists, transposed operators.
/// Results are the same bytes for any number of threads. Memory is allocated on first use and reused; one caller at a time.
class FastSum {
 public:
  /// `points` lie in [-1, 1]^3 and outlive the sum; `widths` > 0. Sums throw Cancelled soon after `cancel` (may be null) is set.
  FastSum(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel = nullptr);
  FastSum(std::vector<Vec3>&&, const Widths&, const SumPlan&, const std::atomic<bool>* = nullptr) = delete;
  /// The points, plan and tree of `other`, with widths that are nowhere larger (std::invalid_argument otherwise): saves most of the time of
  /// another FastSum. Sums that share a tree may not run at the same time.
  FastSum(const FastSum& other, const Widths& narrower);
  ~FastSum();
  FastSum(FastSum&&) noexcept;
  FastSum& operator=(FastSum&&) noexcept;

  [[nodiscard]] std::size_t size() const;
  /// Of the kernel of this point: a length, to the rounding of the plan. O(1).
  [[nodiscard]] double width(std::size_t point) const;

  /// A[u_k] eta at every point, all k in one sweep: N x K row-major. See direct_sum::green.
  std::vector<double> green(const HarmonicValues& u, const std::vector<Vec3>& eta);
  /// sum_k A[u_k]^T q_k; q is N x K row-major. N vectors.
  std::vector<Vec3> green_adjoint(const HarmonicValues& u, const std::vector<double>& q);
  /// S_e eta (N vectors, symmetric positive semidefinite to the accuracy) and W eta (N values) in one sweep.
  /// `factor`: what every eta_i is taken times; empty: 1.
  void stokes_winding(const std::vector<Vec3>& eta, std::vector<Vec3>& s, std::vector<double>& w, const std::vector<double>& factor = {});
  /// W^T q: N vectors.
  std::vector<Vec3> winding_adjoint(const std::vector<double>& q);
  /// out += weight W^T q
  void add_winding_adjoint(const std::vector<double>& q, double weight, std::vector<Vec3>& out);
  /// The vectors of a solve with M = D (S_e + l W^T D^2 W) D + d I, D = diag(roots) (solve/energy_system.h), where the sums run; null where
  /// that is the processor. `roots`: N, or empty for ones. The sum must outlive them.
  [[nodiscard]] std::unique_ptr<SolveVectors> energy_vectors(double damping, double winding_weight, const std::vector<double>& roots);
  /// The same with M = sum_k A[u_k]^T A[u_k].
  [[nodiscard]] std::unique_ptr<SolveVectors> green_vectors(const HarmonicValues& u);
  /// W eta: N values.
  std::vector<double> winding(const std::vector<Vec3>& eta);
  /// -grad w at the points: N vectors, along the outward normals.
  std::vector<Vec3> winding_gradient(const std::vector<Vec3>& eta);

  /// w and -grad w at other targets, where pairs have the width of the source: any order, Q values. O(Q log N); for targets outside [-1,
  /// 1]^3 O(N) more for every power of two between them and the cube that has some. Farther than 2e6 widths, or 2^20 cubes, O(N) each. The
  /// value at a target depends on that target alone, not on the others of the call.
  [[nodiscard]] std::vector<double> winding_at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                                               const std::atomic<bool>* cancel = nullptr) const;
  /// winding_at() of each of `etas`, at least one: faster than one by one, as the lists of the targets are built once.
  [[nodiscard]] std::vector<std::vector<double>> windings_at(const std::vector<std::vector<Vec3>>& etas, const std::vector<Vec3>& targets,
                                                             const std::atomic<bool>* cancel = nullptr) const;
  [[nodiscard]] std::vector<Vec3> winding_gradient_at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                                                      const std::atomic<bool>* cancel = nullptr) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace g3r
