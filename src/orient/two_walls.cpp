#include "orient/two_walls.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "cloud/heights.h"
#include "cloud/layers.h"
#include "cloud/noise.h"
#include "cloud/quadratic_patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace g3r {
namespace {

constexpr double kExact = 0.01;            // site spacings: deviations below are as good as none
constexpr std::size_t kNoisyPoints = 128;  // the same under noise: fewer follow the noise, more the shape

// Calls visit(site, its `count` nearest points in canonical order).
template <typename Visit>
void for_some(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members, std::size_t count, Visit visit) {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  for (std::size_t k = 0; k < members.size(); k += std::max<std::size_t>(1, members.size() / kFewPlaces)) {
    set.tree().nearest(sites.points()[members[k]], count, index, squared);
    std::sort(index.begin(), index.end());
    visit(members[k], index);
  }
}

bool on_exact_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members) {
  const std::vector<Vec3>& points = set.points();
  const Vec3 steps = rounding_steps(points, set.spacing());
  std::vector<double> gain;
  for_some(set, sites, members, 2 * kPatchNeighbours, [&](std::uint32_t s, const std::vector<std::uint32_t>& index) {
    const double spacing = sites.spacing()[s];
    const double one = quadratic_residual(points, index.data(), index.size(), sites.axis[s], spacing);
    const TwoLayers two = fit_two_layers(points, index.data(), index.size(), sites.axis[s]);
    const double exact = kExact * spacing;
    const bool thin = two.gap > 0 && two.gap < kResolved * spacing;
    double rounding = 0;
    for (std::size_t a = 0; a < 3; ++a) rounding += std::abs(sites.axis[s][a]) * steps[a];
    const double cost = (rounding > exact ? 2 : 1) * std::numbers::ln2;
    gain.push_back((thin ? std::log(std::max(one, exact) / std::max(two.deviation, exact)) : 0) - cost);
  });
  return median(gain) > 0;
}

bool on_noisy_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members) {
  const std::vector<Vec3>& points = set.points();
  if (points.size() < kNoisyPoints) return false;
  const Vec3 steps = rounding_steps(points, set.spacing());
  std::vector<HeightMoments> places;
  for_some(set, sites, members, kNoisyPoints, [&](std::uint32_t s, const std::vector<std::uint32_t>& index) {
    places.push_back(height_moments(points, index.data(), index.size(), sites.axis[s], sites.spacing()[s], steps));
  });
  const double held = static_cast<double>(members.size()) * static_cast<double>(points.size()) / static_cast<double>(sites.size());
  return mean_excess(places, held / static_cast<double>(kNoisyPoints)).is_two_walls();
}

}  // namespace

bool on_two_walls(const PointSet& set, const Sites& sites, const std::vector<std::uint32_t>& members, double noise) {
  return on_exact_walls(set, sites, members) || (noise > 0 && on_noisy_walls(set, sites, members));
}

}  // namespace g3r
