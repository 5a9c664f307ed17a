#include "solve/energy_system.h"

#include "cpu/parallel.h"

namespace g3r {
namespace {

constexpr std::size_t kBlock = 4096;  // points per parallel block

}  // namespace

std::vector<Vec3> EnergySystem::apply(const std::vector<Vec3>& eta) {
  std::vector<Vec3> out;
  std::vector<double> w;
  sum_.stokes_winding(eta, out, w);
  const std::vector<Vec3> wt = sum_.winding_adjoint(w);
  parallel::for_blocks(eta.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t a = 0; a < 3; ++a) out[i][a] += damping_ * eta[i][a] + winding_weight_ * wt[i][a];
    }
  });
  return out;
}

std::vector<Vec3> EnergySystem::right_side() { return sum_.winding_adjoint(std::vector<double>(sum_.size(), 0.5 * winding_weight_)); }

}  // namespace g3r
