#include "solve/green_system.h"

namespace g3r {

// A is linear in u, so weighting a row is weighting its harmonic.
HarmonicValues weighted_harmonics(const std::vector<Harmonic>& harmonics, const std::vector<Vec3>& points, double constant_weight) {
  HarmonicValues u = evaluate_harmonics(harmonics, points);
  for (std::size_t k = 0; k < harmonics.size(); ++k) {
    if (harmonics[k].degree != 0) continue;
    for (std::size_t i = k; i < u.value.size(); i += harmonics.size()) u.value[i] *= constant_weight;
  }
  return u;
}

GreenSystem::GreenSystem(FastSum& sum, const std::vector<Vec3>& points, const std::vector<Harmonic>& harmonics, double constant_weight)
    : sum_(sum), u_(weighted_harmonics(harmonics, points, constant_weight)) {}

void GreenSystem::apply(const std::vector<Vec3>& eta, std::vector<Vec3>& product) { product = sum_.green_adjoint(u_, sum_.green(u_, eta)); }

std::vector<Vec3> GreenSystem::right_side() {
  std::vector<double> half(u_.value);
  for (double& v : half) v *= 0.5;
  return sum_.green_adjoint(u_, half);
}

}  // namespace g3r
