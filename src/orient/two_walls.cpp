#include "orient/two_walls.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/heights.h"
#include "cloud/neighbours.h"
#include "cloud/noise.h"
#include "cloud/quadratic_patch.h"
#include "cloud/some_places.h"
#include "cloud/spacing.h"
#include "cloud/two_layers.h"
#include "orient/certified_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace g3r {
namespace {

// Site spacings up to which deviations from a height field count as rounding, of which ratios say nothing.
constexpr double kRoundedDeviation = 0.01;

// Calls visit(site, its `count` nearest points in canonical order) for `places` to twice as many of the members.
template <typename Visit>
void for_some(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members, std::size_t places, std::size_t count,
              Visit visit) {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  const SomePlaces some = SomePlaces::at_least(places, members.size());
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t site = members[some[k]];
    set.tree().nearest(sites.points()[site], count, index, squared);
    std::sort(index.begin(), index.end());
    visit(site, index);
  }
}

// The direction across the surface at a place: of exact points that of their facet, as a plane through two walls a step of a raster apart
// may have any.
Vec3 axis_at(const PointSet& set, const Sites& sites, std::uint32_t s) {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  set.tree().nearest(sites.points()[s], kPlaneNeighbours, index, squared);
  const ExactPlane facet = find_exact_plane(set.points(), index, set.spacing());
  return facet.breadth < kClearlyLess ? sites.axis[s] : facet.normal;
}

// How much likelier two walls are than one around some of the members: visit(site, gain per point) for each.
template <typename Visit>
void for_gains(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members, std::size_t places, Visit visit) {
  const std::vector<Vec3>& points = set.points();
  const Vec3 steps = set.rounding_steps();
  for_some(set, sites, members, places, kTwoPatches, [&](std::uint32_t s, const std::vector<std::uint32_t>& index) {
    const double spacing = sites.spacing()[s];
    const Vec3 axis = axis_at(set, sites, s);
    const double one = quadratic_residual(points, index.data(), index.size(), axis, spacing);
    const TwoLayers two = fit_two_layers(points, index.data(), index.size(), axis);
    const double exact = kRoundedDeviation * spacing;
    const bool thin = two.gap > 0 && two.gap < kResolved * spacing;
    double rounding = 0;
    for (std::size_t a = 0; a < 3; ++a) rounding += std::abs(axis[a]) * steps[a];
    const double cost = (rounding > exact ? 2 : 1) * std::numbers::ln2;
    visit(s, (thin ? std::log(std::max(one, exact) / std::max(two.deviation, exact)) : 0) - cost);
  });
}

// Whether the field is as restless where there is one wall as where there are two.
bool is_restless_beside_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members,
                              const std::vector<double>& unrest) {
  std::vector<Vec3> places;
  std::vector<std::uint32_t> site;
  std::vector<std::uint8_t> on_two;
  for_gains(set, sites, members, kPlaces, [&](std::uint32_t s, double gain) {
    if (unrest[s] < 0) return;
    places.push_back(sites.points()[s]);
    site.push_back(s);
    on_two.push_back(gain > 0 ? 1 : 0);
  });
  const Neighbours tree(places);
  std::array<double, 2> sum{};
  std::array<std::size_t, 2> count{};
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  for (std::size_t k = 0; k < places.size(); ++k) {
    tree.nearest(places[k], kClosest + 1, index, squared);
    std::size_t twos = 0;
    for (const std::uint32_t q : index) twos += on_two[q];
    if (std::min(twos, index.size() - twos) > 1) continue;  // a rim of the walls, or chance
    const std::size_t kind = twos > 1 ? 1 : 0;
    sum[kind] += unrest[site[k]];
    ++count[kind];
  }
  if (count[0] < kFewestSites) return false;
  const double beside = sum[0] / static_cast<double>(count[0]);
  return beside > kUnrest && beside * static_cast<double>(count[1]) >= sum[1];
}

bool on_exact_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members) {
  std::vector<double> gains;
  for_gains(set, sites, members, kFewPlaces, [&](std::uint32_t, double gain) { gains.push_back(gain); });
  return median(std::move(gains)) > 0;
}

bool on_noisy_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members) {
  const std::vector<Vec3>& points = set.points();
  if (points.size() < kWallNeighbours) return false;
  const Vec3 steps = set.rounding_steps();
  std::vector<HeightMoments> places;
  for_some(set, sites, members, kFewPlaces, kWallNeighbours, [&](std::uint32_t s, const std::vector<std::uint32_t>& index) {
    places.push_back(height_moments(points, index.data(), index.size(), sites.axis[s], sites.spacing()[s], steps));
  });
  const double held = static_cast<double>(members.size()) * static_cast<double>(points.size()) / static_cast<double>(sites.size());
  return mean_excess(places, held / static_cast<double>(kWallNeighbours)).is_two_walls();
}

}  // namespace

bool on_two_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members, double noise,
                  const std::vector<double>& unrest) {
  if (on_exact_walls(set, sites, members) && !is_restless_beside_walls(set, sites, members, unrest)) return true;
  return noise > 0 && on_noisy_walls(set, sites, members);
}

}  // namespace g3r
