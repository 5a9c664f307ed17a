// PGR and AGR: the Gauss formula as a damped least-squares problem.
//
// PGR: Lin, Xiao, Shi, Wang, "Surface Reconstruction from Point Clouds without Normals by Parametrizing the Gauss Formula", ACM Trans.
// Graph. 42(2), 2022. It solves (A A^T + c D) xi = 1/2, eta = A^T xi, with A = W, D = diag(A A^T) and c = alpha - 1 (the authors' program:
// 0.05; they advise 0.2 for 10,000 to 20,000 points and 1 for fewer; here 0.2, see baseline.cpp). By A^T (A A^T + c D)^-1 = (A^T D^-1 A + c
// I)^-1 A^T D^-1 the same eta minimises
//   |D^-1/2 (A eta - 1/2)|^2 + c |eta|^2,
// which is how it is solved here, by conjugate gradients.
// AGR: after Ma, Meng, Xiao, Shi, Wang, "Anisotropic Gauss Reconstruction for Unoriented Point Clouds", Comput. & Graph. 2024: the same
// with the rows of three anisotropic fundamental solutions stacked. Theirs come from a convection term; ours from coordinates stretched by
// (3,1,1), (1,3,1), (1,1,3), which the sums of g3r can evaluate (stretched_winding.h). So this is a relative of AGR, not AGR to the letter;
// c = 1 was best on our samples. Both papers clamp the kernel at a width tied to the neighbours; ours is mollified by a Gaussian. Neither
// refines the directions.
#pragma once

#include "baselines/stretched_winding.h"
#include "solve/linear_system.h"

#include <g3r/points.h>

#include <atomic>
#include <vector>

namespace g3r {

/// M = sum_s A_s^T D_s^-1 A_s + c I, b = 1/2 sum_s A_s^T D_s^-1 1, over the stretches s. Two sums per stretch and product.
class GaussSystem : public LinearSystem {
 public:
  /// `stretches`: {(1,1,1)} for PGR. `damping` c > 0, `epsilon` > 0. Points as for FastSum.
  GaussSystem(const std::vector<Vec3>& points, const std::vector<Vec3>& stretches, double epsilon, double damping, const SumPlan& plan,
              const std::atomic<bool>* cancel);

  void apply(const std::vector<Vec3>& eta, std::vector<Vec3>& product) override;
  std::vector<Vec3> right_side() override;

 private:
  struct Rows {
    StretchedWinding winding;
    std::vector<double> weights;  // D^-1
  };
  std::vector<Rows> rows_;
  std::size_t size_;
  double damping_;
};

}  // namespace g3r
