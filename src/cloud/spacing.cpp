#include "cloud/spacing.h"

#include "base/median.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace g3r {
std::vector<double> local_spacing(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near) {
  const std::size_t stride = near.size() / points.size();
  const std::size_t k = std::min(kClosest + 1, stride) - 1;
  const double factor = std::sqrt(std::numbers::pi / static_cast<double>(k));
  std::vector<double> spacing(points.size());
  parallel::for_blocks(points.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = points[i];
      const Vec3& q = points[near[i * stride + k]];
      spacing[i] = std::max(kLeastSpacing, factor * std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
  });
  return spacing;
}

std::vector<double> local_spacing(const std::vector<Vec3>& points) {
  return local_spacing(points, Neighbours(points).of_all(kClosest + 1));
}

std::vector<double> smoothed_spacing(const std::vector<double>& local, const std::vector<std::uint32_t>& near) {
  const std::size_t stride = near.size() / local.size();
  const std::size_t count = std::min(kSpacingNeighbours - 1, stride);
  std::vector<double> logarithm(local.size());
  parallel::for_all(local.size(), [&](std::size_t i) { logarithm[i] = std::log(local[i]); });
  std::vector<double> spacing(local.size());
  parallel::for_blocks(local.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < count; ++k) sum += logarithm[near[i * stride + k]];
      spacing[i] = std::exp(sum / static_cast<double>(count));
    }
  });
  return spacing;
}

std::vector<double> spacing_before_thinning(std::vector<double> local, const std::vector<double>& relative_spacing) {
  for (std::size_t i = 0; i < relative_spacing.size(); ++i) local[i] /= relative_spacing[i];
  return local;
}

double typical_spacing(std::vector<double> local) { return median(std::move(local)); }

}  // namespace g3r
