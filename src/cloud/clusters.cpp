#include "cloud/clusters.h"

#include "cloud/morton.h"

#include <algorithm>
#include <cmath>

namespace g3r {

std::vector<double> Clusters::roots() const {
  std::vector<double> roots = multiplicity;
  for (double& m : roots) m = std::sqrt(m);
  return roots;
}

// The points of a cell follow each other, and centroids lie in their cells: both sorts agree.
Clusters cluster_points(const std::vector<Vec3>& points, double side, const std::vector<double>& relative_spacing) {
  const int level = std::clamp(static_cast<int>(std::ceil(std::log2(2 / side))), 0, kGridBits);
  const int shift = 3 * (kGridBits - level);
  const std::vector<std::uint64_t> codes = morton_codes(points);
  Clusters clusters;
  clusters.cluster_of.resize(points.size());
  for (std::size_t begin = 0; begin < points.size();) {
    Vec3 sum{0, 0, 0};
    double area = 0;
    std::size_t end = begin;
    for (; end < points.size() && codes[end] >> shift == codes[begin] >> shift; ++end) {
      for (std::size_t a = 0; a < 3; ++a) sum[a] += points[end][a];
      area += relative_spacing.empty() ? 1 : relative_spacing[end] * relative_spacing[end];
      clusters.cluster_of[end] = static_cast<std::uint32_t>(clusters.points.size());
    }
    const auto count = static_cast<double>(end - begin);
    const Vec3 centroid{sum[0] / count, sum[1] / count, sum[2] / count};
    clusters.points.push_back(centroid);
    clusters.multiplicity.push_back(area);
    if (!relative_spacing.empty()) clusters.relative_spacing.push_back(std::sqrt(area / count));
    begin = end;
  }
  return clusters;
}

}  // namespace g3r
