#include "field/oriented_cloud.h"

#include "base/vector.h"
#include "field/areas.h"

#include <g3r/error.h>

#include <cmath>

namespace g3r {

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals, const std::vector<double>& areas) {
  std::vector<Vec3> kept;  // all but outliers, which have no area and may be far away
  std::vector<std::size_t> input;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (areas[i] == 0 || !std::isfinite(areas[i]) || !vector::is_finite(normals[i])) continue;
    kept.push_back(points[i]);
    input.push_back(i);
  }
  if (kept.empty()) throw InvalidInput("no surface found: the orientation gives no point an area");
  OrientedCloud out;
  out.cloud = canonical_cloud(PointsView(kept));
  out.eta.assign(out.cloud.size(), Vec3{0, 0, 0});
  const double scale = out.cloud.frame.scale;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::uint32_t p = out.cloud.point_of[k];
    if (p == kNoPoint) continue;
    const double area = areas[input[k]] * scale * scale;  // from the left: the square of a scale may leave the range of double
    for (std::size_t a = 0; a < 3; ++a) out.eta[p][a] += area * normals[input[k]][a];
  }
  out.spacing = out.cloud.set.spacing();
  return out;
}

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals) {
  OrientedCloud out;
  out.cloud = canonical_cloud(points);
  std::vector<Vec3> merged(out.cloud.size(), Vec3{0, 0, 0});
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::uint32_t p = out.cloud.point_of[i];
    if (p == kNoPoint) continue;
    for (std::size_t a = 0; a < 3; ++a) merged[p][a] += normals[i][a] / out.cloud.multiplicity[p];
  }
  out.eta = area_vectors(out.cloud.set, merged, {}, nullptr);
  out.spacing = out.cloud.set.spacing();
  return out;
}

}  // namespace g3r
