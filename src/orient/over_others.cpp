#include "orient/over_others.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace g3r {

std::vector<std::uint8_t> over_others(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const Vec3& up, double noise,
                                      const std::atomic<bool>* cancel) {
  const double tangent = std::sqrt(1 - kSameSide * kSameSide) / kSameSide;
  const auto is_level = [&](std::size_t i) { return std::abs(vector::dot(normals[i], up)) >= kSameSide; };
  std::vector<Vec3> plan(points.size());  // as seen along `up`
  for (std::size_t i = 0; i < points.size(); ++i) {
    plan[i] = vector::subtract(points[i], vector::scale(up, vector::dot(points[i], up)));
  }
  const Neighbours neighbours(plan);
  std::vector<std::uint8_t> marks(points.size(), 0);
  parallel::for_each(
      points.size(),
      [&](std::size_t i) {
        if (!is_level(i)) return;
        std::vector<std::uint32_t> near;
        std::vector<double> squared;
        neighbours.nearest(plan[i], kPatchNeighbours, near, squared);
        const double least = std::max(kLevelRatio * tangent * std::sqrt(squared.back()), kNoiseBreadth * noise);
        const double height = vector::dot(points[i], up);
        marks[i] = std::any_of(near.begin(), near.end(),
                               [&](std::uint32_t j) { return is_level(j) && height - vector::dot(points[j], up) > least; });
      },
      cancel);
  return marks;
}

}  // namespace g3r
