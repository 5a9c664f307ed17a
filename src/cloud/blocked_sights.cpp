#include "cloud/blocked_sights.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

// Points within kWider spacings of a sight that passes through a surface, at least: with more, grids would be transparent.
constexpr std::size_t kFewestAround = 4;

}  // namespace

SeenPoint seen_point(const PointSet& set, std::uint32_t i) {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  set.tree().nearest(set.points()[i], kPatchNeighbours, index, squared);
  const PlaneFit plane = fit_plane(set.points(), index.data(), index.size());
  const double spacing = set.smoothed_spacing()[i];
  return {set.points()[i], plane.normal, spacing, kSigmas * (kWider * spacing + plane.residual)};
}

bool is_blocked(const PointSet& set, const SeenPoint& seen, const Vec3& place) {
  const Vec3 sight = vector::subtract(place, seen.point);
  const double distance = vector::length(sight);
  const Vec3 direction = vector::normalised(sight);
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  for (double t = seen.lift / std::abs(vector::dot(direction, seen.normal)); t < distance - seen.spacing;) {
    set.tree().nearest(vector::add(seen.point, vector::scale(direction, t)), kFewestAround, index, squared);
    const double spacing = set.smoothed_spacing()[index.front()];
    const double radius = kWider * spacing;
    if (squared.back() <= radius * radius) return true;
    t += std::max(std::sqrt(squared.front()) - radius, spacing / 2);
  }
  return false;
}

}  // namespace g3r
