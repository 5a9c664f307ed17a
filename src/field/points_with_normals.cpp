#include "field/points_with_normals.h"

#include "base/vector.h"
#include "cloud/far_points.h"

#include <cmath>
#include <cstdint>

namespace g3r {
namespace {

void leave_out_far(PointsWithNormals& given) {
  const std::vector<std::uint8_t> is_far = far_points(given.points);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < is_far.size(); ++i) {
    if (is_far[i] != 0) {
      given.far.push_back(given.points[i]);
      continue;
    }
    given.points[kept] = given.points[i];
    given.normals[kept++] = given.normals[i];
  }
  if (is_far.empty()) return;
  given.points.resize(kept);
  given.normals.resize(kept);
}

}  // namespace

PointsWithNormals with_normals(const PointsView& points, const PointsView& normals) {
  PointsWithNormals out;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 p = points[i], n = normals[i];
    const double size = std::hypot(n[0], n[1], n[2]);
    const bool is_place = vector::is_finite(p), is_direction = std::isfinite(size) && size > 0;
    out.non_finite += is_place ? 0 : 1;
    out.undirected += is_place && !is_direction ? 1 : 0;
    if (!is_place || !is_direction) continue;
    out.points.push_back(p);
    out.normals.push_back({n[0] / size, n[1] / size, n[2] / size});
  }
  leave_out_far(out);
  return out;
}

}  // namespace g3r
