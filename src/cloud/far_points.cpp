#include "cloud/far_points.h"

#include "base/median.h"
#include "base/vector.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace g3r {
namespace {

// Of the spacing, a rounding of coordinates that moves no normal and makes no outlier.
constexpr double kHardlyRounded = 1e-4;

// The places within `reach` of the middle can share a frame.
struct Surroundings {
  Vec3 middle{};
  double reach = 0;

  [[nodiscard]] double distance(const Vec3& p) const {
    return std::max({std::abs(p[0] - middle[0]), std::abs(p[1] - middle[1]), std::abs(p[2] - middle[2])});
  }
};

// `points`: one at least. Half of n points on a surface as wide as d are about d / sqrt(n) apart, and places at the distance r in their
// frame are rounded by r epsilon / 2.
Surroundings surroundings_of(const std::vector<Vec3>& points) {
  Surroundings out;
  const auto median_of = [&points](const auto& value) {
    std::vector<double> values(points.size());
    std::transform(points.begin(), points.end(), values.begin(), value);
    return median(std::move(values));
  };
  for (std::size_t a = 0; a < 3; ++a) out.middle[a] = median_of([a](const Vec3& p) { return p[a]; });
  const double spacing = median_of([&out](const Vec3& p) { return out.distance(p); }) / std::sqrt(static_cast<double>(points.size()));
  out.reach = kHardlyRounded * spacing / (std::numeric_limits<double>::epsilon() / 2);
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
  if (std::none_of(places.begin(), places.end(), is_far_from(around))) return {};
  std::vector<std::uint8_t> marks(points.count, 0);
  for (std::size_t i = 0; i < points.count; ++i) {
    if (const Vec3 p = points[i]; vector::is_finite(p)) marks[i] = is_far_from(around)(p) ? 1 : 0;
  }
  return marks;
}

}  // namespace g3r
