#include "mesh/smooth_spacing.h"

#include "base/vector.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace g3r::mesh {
std::vector<double> smooth_spacing(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& near) {
  const std::size_t n = positions.size(), stride = near.size() / n, k = std::min(kRing + 1, stride);
  std::vector<double> raw(n), smooth(n);
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 farthest = vector::subtract(positions[near[i * stride + k - 1]], positions[i]);
      raw[i] = vector::dot(farthest, farthest) * std::numbers::pi / static_cast<double>(std::max<std::size_t>(k - 1, 1));
    }
  });
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<double> around(k);
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = 0; j < k; ++j) around[j] = raw[near[i * stride + j]];
      std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(k / 2), around.end());
      smooth[i] = std::sqrt(around[k / 2]);
    }
  });
  return smooth;
}

std::vector<double> smooth_spacing(const std::vector<Vec3>& positions) {
  return smooth_spacing(positions, Neighbours(positions).of_all(kRing + 1));
}

}  // namespace g3r::mesh
