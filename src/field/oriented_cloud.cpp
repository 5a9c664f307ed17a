#include "field/oriented_cloud.h"

#include "base/vector.h"
#include "field/areas.h"

#include <g3r/error.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace g3r {
namespace {

// Sums of the vectors of the points at every place. Those of three and more depend on the order in which they are added: that of their
// coordinates.
template <class VectorOf>
std::vector<Vec3> sums_at_places(const CanonicalCloud& cloud, const VectorOf& vector_of) {
  std::vector<Vec3> sums(cloud.size(), Vec3{0, 0, 0});
  std::vector<std::pair<std::uint32_t, Vec3>> many;
  for (std::size_t i = 0; i < cloud.point_of.size(); ++i) {
    const std::uint32_t p = cloud.point_of[i];
    if (p == kNoPoint) continue;
    if (cloud.multiplicity[p] > 2) {
      many.emplace_back(p, vector_of(i));
    } else {
      sums[p] = vector::add(sums[p], vector_of(i));
    }
  }
  std::sort(many.begin(), many.end());
  for (const auto& [p, v] : many) sums[p] = vector::add(sums[p], v);
  return sums;
}

// Whether the unit normals at a place cancel but for the rounding of files: their mean is no direction.
bool cancel(const Vec3& mean) { return vector::length(mean) <= std::numeric_limits<float>::epsilon(); }

}  // namespace

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals, const std::vector<double>& areas, double spacing) {
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
  const double scale = out.cloud.frame.scale;
  out.eta = sums_at_places(out.cloud, [&](std::size_t k) {
    const double area = areas[input[k]] * scale * scale;  // from the left: the square of a scale may leave the range of double
    return vector::scale(normals[input[k]], area);
  });
  out.spacing = spacing > 0 ? out.cloud.frame.length_to_unit(spacing) : out.cloud.set.spacing();
  return out;
}

OrientedCloud oriented_cloud(const PointsView& points, const std::vector<Vec3>& normals) {
  OrientedCloud out;
  out.cloud = canonical_cloud(points);
  const CanonicalCloud& cloud = out.cloud;
  const std::vector<Vec3> merged = sums_at_places(cloud, [&](std::size_t i) {
    const auto copies = static_cast<double>(cloud.multiplicity[cloud.point_of[i]]);
    return Vec3{normals[i][0] / copies, normals[i][1] / copies, normals[i][2] / copies};
  });
  if (std::any_of(merged.begin(), merged.end(), cancel)) {
    std::vector<Vec3> directed, directions;
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const std::uint32_t p = cloud.point_of[i];
      if (p == kNoPoint || cancel(merged[p])) continue;
      directed.push_back(points[i]);
      directions.push_back(normals[i]);
    }
    out = oriented_cloud(directed, directions);
    out.undirected = normals.size() - directed.size();
    return out;
  }
  out.eta = area_vectors(out.cloud.set, merged, {}, nullptr);
  out.spacing = out.cloud.set.spacing();
  return out;
}

}  // namespace g3r
