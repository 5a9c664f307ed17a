#include "solve/part_system.h"

#include "base/vector.h"

#include <cmath>

namespace g3r {
namespace {

double length_of(const std::vector<Vec3>& vectors) {
  double sum = 0;
  for (const Vec3& v : vectors) sum += vector::dot(v, v);
  return std::sqrt(sum);
}

class PartSystem : public LinearSystem {
 public:
  PartSystem(LinearSystem& part, const std::vector<Vec3>& residual) : part_(part), residual_(residual) {}
  void apply(const std::vector<Vec3>& x, std::vector<Vec3>& product) override { part_.apply(x, product); }
  std::vector<Vec3> right_side() override { return residual_; }
  std::unique_ptr<SolveVectors> vectors_elsewhere() override { return part_.vectors_elsewhere(); }

 private:
  LinearSystem& part_;
  const std::vector<Vec3>& residual_;
};

}  // namespace

PartResidual residual_at(const std::vector<std::uint32_t>& some, LinearSystem& system, const std::vector<Vec3>& x) {
  const std::vector<Vec3> right = system.right_side();
  PartResidual out{values_at(some, product_of(system, x)), length_of(right)};
  for (std::size_t k = 0; k < some.size(); ++k) out.residual[k] = vector::subtract(right[some[k]], out.residual[k]);
  return out;
}

IterativeResult solve_for_part(LinearSystem& part, const PartResidual& right, const std::vector<Steps>& schedule, double tolerance,
                               const std::function<void(int, int, double)>& after_step) {
  PartSystem system(part, right.residual);
  const double here = length_of(right.residual);
  const double share = here > 0 ? here / right.size : 1;
  IterativeResult result = solve_iteratively(system, schedule, tolerance / share, {}, after_step);
  for (double& r : result.residuals) r *= share;
  return result;
}

}  // namespace g3r
