#include "orient/confidence.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/wanted.h"

#include <algorithm>
#include <cmath>

namespace g3r {

std::vector<float> side_confidence(const std::vector<Vec3>& eta, const std::vector<Vec3>& normals, const std::vector<double>& jumps,
                                   const std::vector<double>& areas) {
  std::vector<double> sizes(eta.size()), shares(eta.size());
  parallel::for_all(eta.size(), [&](std::size_t i) {
    const double area = areas[areas.size() == 1 ? 0 : i];
    sizes[i] = vector::length(eta[i]);
    shares[i] = area > 0 ? sizes[i] / area : 0;
  });
  // Sizes that are not clearly less than most do not lower the confidence.
  const double full_share = kClearlyLess * median(shares);
  const double full_jump = jumps.empty() ? 0 : kClearlyLess * median(jumps);
  std::vector<float> confidence(eta.size(), 0.0F);
  parallel::for_all(eta.size(), [&](std::size_t i) {
    if (!(sizes[i] > 0)) return;
    const double cosine = (eta[i][0] * normals[i][0] + eta[i][1] * normals[i][1] + eta[i][2] * normals[i][2]) / sizes[i];
    double c = std::clamp((1 + cosine) / 2, 0.0, 1.0) * std::min(1.0, shares[i] / full_share);
    if (full_jump > 0) c *= std::min(1.0, jumps[i] / full_jump);
    confidence[i] = static_cast<float>(c);
  });
  return confidence;
}

Sums sums_over(const std::vector<std::uint32_t>& near, const std::vector<Vec3>& vectors) {
  const std::size_t stride = near.size() / vectors.size();
  Sums sums{std::vector<Vec3>(vectors.size(), Vec3{0, 0, 0}), std::vector<double>(vectors.size(), 0)};
  parallel::for_all(vectors.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < stride; ++k) {
      const Vec3& v = vectors[near[i * stride + k]];
      for (std::size_t a = 0; a < 3; ++a) sums.vectors[i][a] += v[a];
      sums.lengths[i] += vector::length(v);
    }
  });
  return sums;
}

void limit_to_evidence(std::size_t points, std::vector<float>& confidence) {
  const double neighbourhoods = static_cast<double>(points) / static_cast<double>(kSpacingNeighbours);
  const auto left = static_cast<float>(neighbourhoods / (neighbourhoods + 2));
  for (float& c : confidence) c = std::min(c, kUndecided) + std::max(0.0F, c - kUndecided) * left;
}

std::vector<std::uint8_t> unsure_points(const std::vector<float>& confidence) {
  std::vector<std::uint8_t> unsure(confidence.size());
  for (std::size_t i = 0; i < unsure.size(); ++i) unsure[i] = confidence[i] < kUndecided ? 1 : 0;
  return unsure;
}

double unsure_share(const std::vector<float>& confidence, const std::vector<std::uint8_t>& wanted) {
  return share_of_wanted(wanted, confidence.size(), [&](std::size_t i) { return confidence[i] < kUndecided; });
}

}  // namespace g3r
