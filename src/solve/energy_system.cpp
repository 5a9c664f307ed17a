#include "solve/energy_system.h"

#include "cpu/parallel.h"

#include <utility>

namespace g3r {
namespace {

constexpr std::size_t kBlock = 4096;  // points per parallel block
const std::vector<double> kOnes;

// v_i *= factor(i)
template <class Factor>
void scale(std::vector<Vec3>& v, const Factor& factor) {
  parallel::for_blocks(v.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (double& c : v[i]) c *= factor(i);
    }
  });
}

}  // namespace

EnergySystem::EnergySystem(FastSum& sum, double damping, double winding_weight, const std::vector<double>& roots)
    : sum_(sum), damping_(damping), winding_weight_(winding_weight), root_(roots) {}

EnergySystem::EnergySystem(FastSum& sum, double damping, double winding_weight) : EnergySystem(sum, damping, winding_weight, kOnes) {}

std::vector<Vec3> EnergySystem::to_areas(std::vector<Vec3> x) const {
  if (!root_.empty()) scale(x, [&](std::size_t i) { return root_[i]; });
  return x;
}

std::vector<Vec3> EnergySystem::from_areas(std::vector<Vec3> eta) const {
  if (!root_.empty()) scale(eta, [&](std::size_t i) { return 1 / root_[i]; });
  return eta;
}

void EnergySystem::apply(const std::vector<Vec3>& x, std::vector<Vec3>& s) {
  sum_.stokes_winding(x, s, w_, root_);
  weight(w_);
  sum_.add_winding_adjoint(w_, winding_weight_, s);
  parallel::for_blocks(x.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double root = root_.empty() ? 1 : root_[i];
      for (std::size_t a = 0; a < 3; ++a) s[i][a] = root * s[i][a] + damping_ * x[i][a];
    }
  });
}

void EnergySystem::weight(std::vector<double>& w) const {
  parallel::for_all(root_.size(), [&](std::size_t i) { w[i] *= root_[i] * root_[i]; });
}

std::vector<Vec3> EnergySystem::right_side() {
  std::vector<double> half(sum_.size(), 0.5 * winding_weight_);
  weight(half);
  return to_areas(sum_.winding_adjoint(half));
}

}  // namespace g3r
