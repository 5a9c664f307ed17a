#include "orient/confidence.h"

#include "base/median.h"

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

constexpr float kUnsure = 0.5F;    // confidence below which a point counts as unsure
constexpr double kFullSize = 0.5;  // share of the median from which a size no longer lowers the confidence

double length(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

std::vector<float> side_confidence(const std::vector<Vec3>& eta, const std::vector<Vec3>& normals, const std::vector<double>& strength,
                                   const std::vector<double>& spacing) {
  const auto h = [&spacing](std::size_t i) { return spacing.empty() ? 1 : spacing[i]; };
  std::vector<double> sizes(eta.size()), areas(eta.size()), jumps(strength.size());
  for (std::size_t i = 0; i < eta.size(); ++i) {
    sizes[i] = length(eta[i]);
    areas[i] = sizes[i] / (h(i) * h(i));
    if (!strength.empty()) jumps[i] = strength[i] * h(i);
  }
  const double full_area = kFullSize * median(areas);
  const double full_jump = jumps.empty() ? 0 : kFullSize * median(jumps);
  std::vector<float> confidence(eta.size(), 0.0F);
  for (std::size_t i = 0; i < eta.size(); ++i) {
    if (!(sizes[i] > 0)) continue;
    const double cosine = (eta[i][0] * normals[i][0] + eta[i][1] * normals[i][1] + eta[i][2] * normals[i][2]) / sizes[i];
    double c = std::clamp((1 + cosine) / 2, 0.0, 1.0) * std::min(1.0, areas[i] / full_area);
    if (full_jump > 0) c *= std::min(1.0, jumps[i] / full_jump);
    confidence[i] = static_cast<float>(c);
  }
  return confidence;
}

std::vector<Vec3> sums_over(const std::vector<std::uint32_t>& near, const std::vector<Vec3>& vectors) {
  const std::size_t stride = near.size() / vectors.size();
  std::vector<Vec3> sums(vectors.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < sums.size(); ++i) {
    for (std::size_t k = 0; k < stride; ++k) {
      for (std::size_t a = 0; a < 3; ++a) sums[i][a] += vectors[near[i * stride + k]][a];
    }
  }
  return sums;
}

std::vector<std::uint8_t> unsure_points(const std::vector<float>& confidence) {
  std::vector<std::uint8_t> unsure(confidence.size());
  for (std::size_t i = 0; i < unsure.size(); ++i) unsure[i] = confidence[i] < kUnsure ? 1 : 0;
  return unsure;
}

double unsure_share(const std::vector<float>& confidence) {
  const auto unsure = std::count_if(confidence.begin(), confidence.end(), [](float c) { return c < kUnsure; });
  return static_cast<double>(unsure) / static_cast<double>(confidence.size());
}

}  // namespace g3r
