#include "cloud/blocked_sights.h"

#include "base/vector.h"
#include "cloud/constants.h"
#include "cloud/plane_fit.h"
#include "cloud/some_places.h"
#include "cpu/parallel.h"

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

double hidden_share(const PointSet& set, const Views& views, const std::atomic<bool>* cancel) {
  if (set.size() < kFewestSurfacePoints) return 0;
  (void)set.smoothed_spacing();  // made here, as the loop below only reads them
  (void)set.tree();
  const SomePlaces some = SomePlaces::at_least(kFewPlaces, set.size());
  std::vector<double> cosine(some.size(), 0);
  std::vector<std::uint8_t> hidden(some.size(), 0);
  parallel::for_each(
      some.size(),
      [&](std::size_t k) {
        const auto i = static_cast<std::uint32_t>(some[k]);
        const SeenPoint seen = seen_point(set, i);
        cosine[k] = std::abs(vector::dot(seen.normal, vector::normalised(vector::subtract(views.place_of(i), seen.point))));
        hidden[k] = is_blocked(set, seen, views.place_of(i)) ? 1 : 0;
      },
      cancel);
  double of_hidden = 0;
  double all = 0;
  for (std::size_t k = 0; k < some.size(); ++k) {
    all += cosine[k];
    of_hidden += hidden[k] * cosine[k];
  }
  return all > 0 ? of_hidden / all : 0;
}

}  // namespace g3r
