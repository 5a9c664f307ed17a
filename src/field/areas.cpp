#include "field/areas.h"

#include "base/median.h"
#include "cpu/parallel.h"
#include "field/winding_sampler.h"
#include "mesh/held_points.h"
#include "orient/site_parts.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

// The bounds of c. It is 0.35 under noise of 3 h and 1.27 on a square grid; beyond them w is not that of a closed surface, and areas would
// follow it.
constexpr double kLeast = 1.0 / 3;
constexpr double kMost = 1.3;

}  // namespace

double area_factor(double level) { return std::abs(level) > 0 ? std::clamp(0.5 / std::abs(level), kLeast, kMost) : kMost; }

std::vector<Vec3> area_vectors(const PointSet& set, const std::vector<Vec3>& normals, const OpenSurfaces& surfaces,
                               const std::atomic<bool>* cancel) {
  std::vector<double> spacing = set.smoothed_spacing();
  const std::vector<std::uint8_t> held = mesh::held_points(set, normals, cancel);
  const double typical = set.spacing();
  make_room_for_sums(set);
  std::vector<Vec3> eta = normals;
  parallel::for_all(eta.size(), [&](std::size_t i) {
    if (held[i] == 0) spacing[i] = std::min(spacing[i], typical);  // the emptiness around a stray is not its surface
    for (double& c : eta[i]) c *= spacing[i] * spacing[i];
    spacing[i] *= kFieldWidth;
  });
  FastSum sum(set.points(), Widths(std::move(spacing)), sum_plan(kFieldAccuracy, set.size()), cancel);
  std::vector<double> winding = sum.winding(eta);
  if (!surfaces.part.empty()) {
    std::vector<double> closed;
    for (std::size_t i = 0; i < winding.size(); ++i) {
      if (!surfaces.is_open(i)) closed.push_back(winding[i]);
    }
    if (closed.empty()) return eta;
    winding = std::move(closed);
  }
  const double factor = area_factor(median(std::move(winding)));
  parallel::for_all(eta.size(), [&](std::size_t i) {
    for (double& c : eta[i]) c *= factor;
  });
  return eta;
}

}  // namespace g3r
