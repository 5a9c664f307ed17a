#include "solve/green_system.h"

namespace g3r {

GreenSystem::GreenSystem(FastSum& sum, const std::vector<Vec3>& points, const std::vector<Harmonic>& harmonics)
    : sum_(sum), u_(evaluate_harmonics(harmonics, points)) {}

void GreenSystem::apply(const std::vector<Vec3>& eta, std::vector<Vec3>& product) { product = sum_.green_adjoint(u_, sum_.green(u_, eta)); }

std::vector<Vec3> GreenSystem::right_side() {
  std::vector<double> half(u_.value);
  for (double& v : half) v *= 0.5;
  return sum_.green_adjoint(u_, half);
}

}  // namespace g3r
