// The polish of points that a wide kernel cannot distinguish, taken together.
#pragma once

#include "cloud/clusters.h"
#include "orient/polish.h"

#include <vector>

namespace g3r {

/// N points in canonical order, how many times as far apart as is typical each is (empty: all are typical), and their clusters.
struct Clustered {
  const std::vector<Vec3>& points;
  const std::vector<double>& relative_spacing;
  const Clusters& clusters;
};

/// polish() of the clusters, of which each is one point with the area of all of its own: a quarter of the unknowns where cells are two
/// spacings wide, and the same normals while they are no wider than what the kernels see as one. `start`: the refinement of the clusters.
/// Of every point: its share of the area vector of its cluster, in proportion to the area that it stands for, and the refinement at the
/// point itself, by kernels of the typical settings.polish.width; by those of its own width where it is alone. Throws Cancelled.
[[nodiscard]] Polished polish_clusters(const Clustered& of, const Settings& settings, Refinement start, Stages& stages);

/// Of every cluster the mean of its points' normals, each as long as the field jumps there: short where they face either way. What
/// polish_clusters() starts from.
[[nodiscard]] Refinement mean_of_clusters(const Clusters& clusters, const Refinement& points);

}  // namespace g3r
