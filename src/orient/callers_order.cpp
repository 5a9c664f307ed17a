#include "orient/callers_order.h"

#include "cpu/parallel.h"

#include <cmath>
#include <cstddef>

namespace g3r {

void to_callers_order(const CanonicalCloud& cloud, const Solution& solution, const std::vector<float>& confidence, Orientation& out) {
  const std::size_t n = cloud.point_of.size();
  const std::vector<Vec3>& eta = solution.eta;
  out.normals.assign(n, Vec3{0, 0, 0});
  out.areas.assign(n, 0);
  out.confidence.assign(n, 0);
  parallel::for_all(n, [&](std::size_t i) {
    const std::uint32_t p = cloud.point_of[i];
    if (p == kNoPoint) return;
    out.normals[i] = solution.refinement.normals[p];
    // One length at a time: the square of a scale may leave the range of double where the area 0 does not.
    const double area = std::hypot(eta[p][0], eta[p][1], eta[p][2]) / cloud.multiplicity[p];
    out.areas[i] = cloud.frame.length_to_world(cloud.frame.length_to_world(area));
    out.confidence[i] = confidence[p];
  });
}

std::vector<std::uint8_t> open_in_callers_order(const CanonicalCloud& cloud, const OpenSurfaces& surfaces) {
  std::vector<std::uint8_t> open(cloud.point_of.size(), 0);
  for (std::size_t i = 0; i < open.size(); ++i) {
    const std::uint32_t p = cloud.point_of[i];
    if (surfaces.is_open(p)) open[i] = 1;
  }
  return open;
}

}  // namespace g3r
