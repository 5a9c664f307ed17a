#include "orient/clustered_polish.h"

#include "base/vector.h"
#include "sum/fast_sum.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace g3r {

Polished polish_clusters(const Clustered& of, const Settings& settings, Refinement start, Stages& stages) {
  const Clusters& clusters = of.clusters;
  const std::vector<double> spacing = scaled(settings.spacing, clusters.relative_spacing);
  const std::vector<double> areas = scaled(settings.spacing * settings.spacing, clusters.multiplicity);
  const Polished polished = polish({clusters.points, spacing, areas, clusters.roots()}, settings, std::move(start), stages);
  const std::vector<Vec3>& eta = polished.eta;
  std::vector<std::uint32_t> members(clusters.points.size(), 0);
  for (const std::uint32_t c : clusters.cluster_of) ++members[c];
  Polished out;
  out.eta.resize(of.points.size());
  for (std::size_t i = 0; i < out.eta.size(); ++i) {
    const std::uint32_t c = clusters.cluster_of[i];
    const double area = of.relative_spacing.empty() ? 1 : of.relative_spacing[i] * of.relative_spacing[i];
    for (std::size_t a = 0; a < 3; ++a) out.eta[i][a] = eta[c][a] * area / clusters.multiplicity[c];
  }
  const FastSum field(clusters.points, Widths(settings.polish.width.typical()), settings.sums, stages.cancel());
  out.refinement = unit_normals(field.winding_gradient_at(eta, of.points, stages.cancel()), out.eta);
  for (double& jump : out.refinement.strength) jump *= settings.polish.width.typical();
  for (std::size_t i = 0; i < out.eta.size(); ++i) {  // points by themselves are sparse, and have kernels of their own width
    const std::uint32_t c = clusters.cluster_of[i];
    if (members[c] > 1) continue;
    out.refinement.normals[i] = polished.refinement.normals[c];
    out.refinement.strength[i] = polished.refinement.strength[c];
  }
  return out;
}

Refinement mean_of_clusters(const Clusters& clusters, const Refinement& points) {
  Refinement mean{std::vector<Vec3>(clusters.points.size(), Vec3{0, 0, 0}), std::vector<double>(clusters.points.size(), 0)};
  std::vector<double> members(clusters.points.size(), 0);
  for (std::size_t i = 0; i < clusters.cluster_of.size(); ++i) {
    const std::uint32_t c = clusters.cluster_of[i];
    mean.normals[c] = vector::add(mean.normals[c], vector::scale(points.normals[i], points.strength[i]));
    ++members[c];
  }
  for (std::size_t c = 0; c < members.size(); ++c) {
    mean.strength[c] = std::sqrt(vector::dot(mean.normals[c], mean.normals[c])) / members[c];
    mean.normals[c] = vector::normalised(mean.normals[c]);
  }
  return mean;
}

}  // namespace g3r
