#include "cloud/far_points.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cloud/spacing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace g3r {
namespace {

// The places within `reach` of the middle can share a frame.
struct Surroundings {
  Vec3 middle{};
  double reach = 0;

  [[nodiscard]] double distance(const Vec3& p) const {
    return std::max({std::abs(p[0] - middle[0]), std::abs(p[1] - middle[1]), std::abs(p[2] - middle[2])});
  }
};

// `points`: one at least. The middle is the point nearest to the medians, as these need not be where any point is. Half of n points on a
// surface as wide as d are about d / sqrt(n) apart, and in a frame as wide as r kBoxSide / r of that.
Surroundings surroundings_of(const std::vector<Vec3>& points) {
  Surroundings out;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> values(points.size());
    std::transform(points.begin(), points.end(), values.begin(), [a](const Vec3& p) { return p[a]; });
    out.middle[a] = median(std::move(values));
  }
  const auto nearer = [&out](const Vec3& p, const Vec3& q) { return std::pair(out.distance(p), p) < std::pair(out.distance(q), q); };
  out.middle = *std::min_element(points.begin(), points.end(), nearer);
  std::vector<double> distances(points.size());
  std::transform(points.begin(), points.end(), distances.begin(), [&out](const Vec3& p) { return out.distance(p); });
  const auto half = distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) / 2);
  std::nth_element(distances.begin(), half, distances.end());
  out.reach = *half / std::sqrt(static_cast<double>(points.size())) * kBoxSide / kLeastSpacing;
  return out;
}

}  // namespace

std::vector<std::uint8_t> far_points(const PointsView& points) {
  std::vector<Vec3> places;
  places.reserve(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    if (const Vec3 p = points[i]; vector::is_finite(p)) places.push_back(p);
  }
  if (places.empty()) return {};
  const auto is_far_from = [](const Surroundings& around) {
    return [&around](const Vec3& p) { return around.distance(p) > around.reach; };
  };
  const Surroundings with_copies = surroundings_of(places);
  if (std::none_of(places.begin(), places.end(), is_far_from(with_copies))) return {};
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  const Surroundings around = surroundings_of(places);
  const auto far = static_cast<std::size_t>(std::count_if(places.begin(), places.end(), is_far_from(around)));
  if (far == 0 || places.size() - far < kLeastPoints) return {};
  std::vector<std::uint8_t> marks(points.count, 0);
  for (std::size_t i = 0; i < points.count; ++i) {
    if (const Vec3 p = points[i]; vector::is_finite(p)) marks[i] = is_far_from(around)(p) ? 1 : 0;
  }
  return marks;
}

}  // namespace g3r
