#include "tiles/coarse_sides.h"

#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "orient/settings.h"
#include "sum/fast_sum.h"
#include "tiles/thinned.h"

#include <algorithm>
#include <cmath>

namespace g3r::tiles {
namespace {

std::vector<CoarseNormal> nearest_of(const Thinned& thinned, const TileCloud& cloud) {
  const Neighbours tree(thinned.points);
  std::vector<CoarseNormal> nearest(cloud.points.size());
  parallel::for_blocks(nearest.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double squared = HUGE_VAL;
      nearest[i] = thinned.found[cloud.coarse[i] != kNotCoarse ? cloud.coarse[i] : tree.nearest(cloud.points[i], squared, 0)];
    }
  });
  return nearest;
}

std::vector<Vec3> gradient_of(const OrientedCloud& oriented, const TileCloud& cloud, const std::atomic<bool>* cancel) {
  std::vector<Vec3> targets(cloud.points.size());
  parallel::for_all(targets.size(), [&](std::size_t i) { targets[i] = oriented.cloud.frame.to_unit(cloud.points[i]); });
  const FastSum field(oriented.cloud.points(), Widths(kRefinementWidth * oriented.spacing),
                      sum_plan(kContinuedAccuracy, oriented.cloud.size()), cancel);
  return field.winding_gradient_at(oriented.eta, targets, cancel);
}

}  // namespace

CoarseSides coarse_sides(const std::string& folder, const Manifest& m, const TileCloud& cloud, const std::atomic<bool>* cancel) {
  const Thinned thinned = read_thinned(folder, m);
  return {gradient_of(with_areas(thinned, m), cloud, cancel), nearest_of(thinned, cloud)};
}

}  // namespace g3r::tiles
