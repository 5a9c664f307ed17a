// From the solved area vectors to normals: one evaluation of the winding gradient, and how far to trust each.
#pragma once

#include "sum/fast_sum.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// n_i ~ -grad w_s(x_i), normalised (docs/math.md, "Refinement"): the solved vectors have the right side almost everywhere but noisy
/// directions; the gradient of their field fixes the directions. Where it vanishes the normalised eta stays.
struct Refinement {
  std::vector<Vec3> normals;     ///< N unit vectors
  std::vector<double> strength;  ///< N: |grad w_s| s, the jump of w there: the same on any smooth surface, however wide its kernels
};
/// `eta`: N area vectors. One sweep of `sum`, whose width is s.
[[nodiscard]] Refinement refine_normals(FastSum& sum, const std::vector<Vec3>& eta);

/// The same from gradients already evaluated; strengths are their lengths, which the caller takes times the width.
[[nodiscard]] Refinement unit_normals(std::vector<Vec3> gradients, const std::vector<Vec3>& eta);

/// Unit vectors along eta; (0, 0, 1) where eta vanishes.
[[nodiscard]] std::vector<Vec3> normalised(const std::vector<Vec3>& eta);

}  // namespace g3r
