// Expansions of 1/|x - y| in real solid harmonics, and the matrices that move them. Notation and proofs: docs/math.md, "Expansions".
//
// R_l^m = r^l P_l^m e^{i m phi} / (l+m)! (regular), S_l^m = (l-m)! P_l^m e^{i m phi} / r^{l+1} (irregular), both with (-1)^m.
// The real basis B_a(b) holds Re R_l^m (m >= 0) and Im R_l^m (m > 0) of a point b relative to a centre, in units of the cube's half side.
//   P2M  M_a = sum_i q_i B_a(y_i - c_s)            M2M  M_parent = T M_child
//   M2L  L = K(c_t - c_s) M, 1/|x-y| = B(x-c_t)^T K B(y-c_s)
//   L2L  L_child = T^T L_parent / 2                L2P  phi(x) = B(x - c_t) . L / half_side
// Local expansions are stored times the half side, so that no matrix depends on the level.
// Sources: Epton and Dembart 1995; Greengard and Rokhlin 1997; the normalisation is that of Wang and LeSar 1996.
#pragma once

#include "kernels/expansion_index.h"
#include "tree/interaction_lists.h"

#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <vector>

namespace g3r {

/// B_a(b) for all a up to order p.
[[nodiscard]] std::vector<double> regular_harmonics(const Vec3& b, int order);
/// Re S_l^m and Im S_l^m in the same index order. |d| > 0.
[[nodiscard]] std::vector<double> irregular_harmonics(const Vec3& d, int order);

/// T of M2M for a child whose centre is at `shift` (in parent half sides, +-1/2 each) and whose half side is half the parent's. Row-major.
[[nodiscard]] std::vector<double> multipole_translation(const Vec3& shift, int order);

/// Makes K of M2L for any offset: a table of the two irregular harmonics behind every entry, built once per order.
class MultipoleToLocal {
 public:
  explicit MultipoleToLocal(int order);
  /// K for an offset, row-major, times (target half side / smaller half side) as stored local expansions want it.
  [[nodiscard]] std::vector<double> matrix(const Offset& offset) const;

 private:
  struct Entry {
    std::uint32_t first;   ///< index into the irregular harmonics of degree j + n, order k + q
    std::uint32_t second;  ///< order |k - q|
    double first_factor;
    double second_factor;
  };
  int order_;
  std::vector<Entry> entries_;  ///< n x n, row-major
};

}  // namespace g3r
