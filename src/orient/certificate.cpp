#include "orient/certificate.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "sum/fast_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace g3r {
namespace {

constexpr std::array<double, 4> kDistances = {1, 2, 4, 8};  // spacings: walls are seen at the smaller ones, emptiness at the larger
constexpr double kFarthestJump = 4;                         // spacings: farther away the surface bends
constexpr double kWidth = 0.4;  // typical spacings, of the field: single sites are not seen at the nearest probes, walls of a spacing are
constexpr double kApart = 1.9;  // spacings between a probe and any site, so that the field there knows of no single ones
constexpr double kMostFactor = 1.3;  // of the areas: those of points that scatter are too large, of a grid too small
constexpr std::size_t kBlock = 256;  // sites per parallel block

}  // namespace

Certificate certify(const Sites& sites, const std::vector<Vec3>& normals, const std::vector<double>& reach, const SumPlan& sums,
                    const std::atomic<bool>* cancel) {
  const std::size_t count = sites.size();
  const std::vector<Vec3>& points = sites.points();
  const std::vector<double>& spacing = sites.spacing();
  std::vector<Vec3> eta(count);
  for (std::size_t i = 0; i < count; ++i) eta[i] = vector::scale(normals[i], spacing[i] * spacing[i]);
  const FastSum field(points, sites.set.morton(), Widths(kWidth * sites.set.spacing()), sums, cancel);
  const Neighbours& tree = sites.set.tree();
  Certificate out;
  out.jump.assign(count, -HUGE_VAL);
  out.jump_defect.assign(count, 0);
  out.unrest.assign(count, 0);
  std::vector<double> quiet(count, 0);
  const auto side_of = [&](std::size_t i) { return vector::dot(normals[i], sites.axis[i]) < 0 ? -1.0 : 1.0; };
  std::array<std::vector<double>, kDistances.size()> w;
  std::vector<std::uint8_t> is_quiet(2 * count * kDistances.size(), 0);
  std::vector<Vec3> probes(2 * count);
  for (std::size_t d = 0; d < kDistances.size(); ++d) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 step = vector::scale(sites.axis[i], side_of(i) * kDistances[d] * spacing[i]);
      probes[i] = vector::subtract(points[i], step);
      probes[count + i] = vector::add(points[i], step);
    }
    w[d] = field.winding_at(eta, probes, cancel);
    parallel::for_blocks(2 * count, kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const double apart = kApart * spacing[k % count];
        double squared = apart * apart;
        if (kDistances[d] * spacing[k % count] > reach[k % count]) continue;
        is_quiet[2 * count * d + k] = tree.nearest(probes[k], squared, UINT32_MAX) == UINT32_MAX ? 1 : 0;
      }
    });
  }
  // Areas are known up to a factor near 1, for points that scatter it is too large: inside, w is 1.
  std::vector<double> inside;
  for (std::size_t d = 0; d < kDistances.size(); ++d) {
    for (std::size_t k = 0; k < 2 * count; ++k) {
      if (is_quiet[2 * count * d + k] != 0 && w[d][k] > 0.5) inside.push_back(w[d][k]);
    }
  }
  const double factor = inside.empty() ? 1 : std::clamp(1 / median(inside), 1 / kMostFactor, kMostFactor);
  for (std::size_t d = 0; d < kDistances.size(); ++d) {
    for (std::size_t i = 0; i < count; ++i) {
      const double jump = w[d][i] - w[d][count + i];
      if (kDistances[d] <= kFarthestJump) {
        out.jump[i] = std::max(out.jump[i], jump);
        out.jump_defect[i] += std::abs(1 - jump) / 3;
      }
    }
    for (std::size_t k = 0; k < 2 * count; ++k) {
      if (is_quiet[2 * count * d + k] == 0) continue;
      const double value = factor * w[d][k];
      out.unrest[k % count] += std::min(std::abs(value), std::abs(1 - value));
      ++quiet[k % count];
    }
  }
  for (std::size_t i = 0; i < count; ++i) out.unrest[i] = quiet[i] > 0 ? out.unrest[i] / quiet[i] : -1;
  return out;
}

}  // namespace g3r
