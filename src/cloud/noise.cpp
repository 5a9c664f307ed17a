#include "cloud/noise.h"

#include "base/bisect.h"
#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/layers.h"
#include "cloud/plane_fit.h"
#include "cloud/quadratic_patch.h"
#include "cloud/some_places.h"
#include "cloud/spacing.h"
#include "cloud/viewpoint.h"
#include "cpu/parallel.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>

namespace g3r {
namespace {

// The share of neighbourhoods that are flat: shape lifts this quantile of their residuals more than that of the flattest, kFalseAlarms,
// which are as many as chance may make flat. The same quantile of the layers decides.
constexpr double kFlat = 0.1;
// The scatter in spacings of height fields through kPatchNeighbours points where noise fills their balls, by measurement.
constexpr double kSaturation = 0.57;
// The share of it up to which the scatter of the flattest tells the noise: above, the layers alone do.
constexpr double kFilled = 0.75;
// The values that a rounded coordinate has at least: those of plates and boxes that stand straight have fewer.
constexpr std::size_t kFewestLevels = 5;
// Points of neighbourhoods that may hold three layers: fewer do not show them, more reach around the shape.
constexpr std::size_t kLayerNeighbours = 256;
// The quantile kFlat of the deviations from layers on smooth surfaces, over the noise, by measurement.
constexpr double kLayerBias = 0.92;

double share_of(std::size_t some, std::size_t all) { return static_cast<double>(some) / static_cast<double>(all); }

// Whether a share of the points on planes shows a cloud to consist of facets: where most are on none, it does not.
bool are_many(double share) { return share >= 1 - kMostOf; }

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// value(point, its `count` nearest, their squared distances) of about `places` points, spread along their order, in that order.
template <typename Value>
std::vector<double> at_some(const PointSet& set, std::size_t places, std::size_t count, const Value& value) {
  const std::vector<Vec3>& points = set.points();
  const Neighbours& tree = set.tree();
  const SomePlaces some = SomePlaces::at_least(places, points.size());
  std::vector<double> values(some.size());
  parallel::for_each(values.size(), [&](std::size_t k) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    tree.nearest(points[some[k]], count, index, squared);
    values[k] = value(points[some[k]], index, squared);
  });
  return values;
}

// The residual at this quantile that noise of standard deviation 1 leaves of `count` points, an even number: x with
// P(chi^2 <= d x^2) = share, d = count - kQuadraticTerms, where P = 1 - e^-y (1 + y + y^2 / 2! + ... + y^(d/2 - 1) / (d/2 - 1)!), y = d x^2
// / 2.
double expected_residual(std::size_t count, double share) {
  const std::size_t half = (count - kQuadraticTerms) / 2;
  return last_that([&](double x) {
    const double y = static_cast<double>(half) * x * x;
    double term = 1, sum = 1;
    for (std::size_t k = 1; k < half; ++k) sum += term *= y / static_cast<double>(k);
    return 1 - std::exp(-y) * sum < share;
  });
}

// How far the points are from height fields through `count` of them.
class Residuals {
 public:
  Residuals(const PointSet& set, std::size_t count) : count_(count) {
    const std::vector<Vec3>& points = set.points();
    const double spacing = set.spacing();
    residuals_ = at_some(set, kPlaces, count, [&](const Vec3&, const auto& index, const auto&) {
      const Vec3 normal = fit_plane(points, index.data(), index.size()).normal;
      return quadratic_residual(points, index.data(), index.size(), normal, spacing);
    });
  }
  // The noise that leaves such a residual in this share of the neighbourhoods, while it is small.
  [[nodiscard]] double scatter(double share) const { return quantile(residuals_, share) / expected_residual(count_, share); }

 private:
  std::size_t count_;
  std::vector<double> residuals_;
};

// Standard deviation about layers, of which a neighbourhood may hold up to three.
double layered_noise(const PointSet& set) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  std::vector<double> sigma = at_some(set, kFewPlaces, kLayerNeighbours, [&](const Vec3& point, const auto& index, const auto&) {
    const Vec3 normal = fit_plane(points, index.data(), index.size()).normal;
    return layered_deviation(points, index.data(), index.size(), point, normal);
  });
  const double found = quantile(std::move(sigma), kFlat) / kLayerBias;
  if (found < spacing || points.size() < kTwiceAsFar * kSmallPart * kLayerNeighbours) return found;
  std::vector<Vec3> thinned;
  for (std::size_t i = 0; i < points.size(); i += kTwiceAsFar) thinned.push_back(points[i]);
  return layered_noise(PointSet(std::move(thinned)));
}

// The facet that the first of the points is on; none, of breadth 0, where the points may be those of rows: the lines of a raster or a
// scanner lie in planes across the surface however noisy it is, but in narrow strips of them, or there is another plane among the other
// points.
ExactPlane find_facet(const PointSet& set, const std::vector<std::uint32_t>& index) {
  const std::vector<Vec3>& points = set.points();
  const ExactPlane plane = find_exact_plane(points, index, set.spacing());
  if (plane.breadth < kClearlyLess || is_along_sight(set, index.front(), plane.normal)) return {};
  return find_exact_plane(points, beside_plane(index, plane.points), set.spacing()).points.empty() ? plane : ExactPlane{};
}

// Whether many of the points lie on exact planes along the surface, and not because rounding has put them there.
bool on_exact_planes(const PointSet& set) {
  const Vec3 steps = set.rounding_steps();
  if (std::max({steps[0], steps[1], steps[2]}) > 0) return false;
  const std::vector<double> on_facet = at_some(set, kPlaces, kPlaneNeighbours, [&](const Vec3&, const auto& index, const auto&) {
    const ExactPlane facet = find_facet(set, index);
    if (facet.breadth == 0) return 0.0;
    const Vec3 around = fit_plane(set.points(), index.data(), index.size()).normal;
    return std::abs(vector::dot(facet.normal, around)) > kSameSide ? 1.0 : 0.0;
  });
  return are_many(share_of(static_cast<std::size_t>(std::count(on_facet.begin(), on_facet.end(), 1.0)), on_facet.size()));
}

// Whether planes show that there is no noise: exact ones, or those of facets about which points scatter too little to blur anything.
bool shows_no_noise(const PointSet& set) {
  if (on_exact_planes(set)) return true;
  const double scatter = facet_scatter(set);
  return scatter > 0 && scatter < kLeastNoise * set.spacing();
}

// By the flattest neighbourhoods, 0 where these or planes show that there is none.
double scattered_noise(const PointSet& set, const Residuals& residuals) {
  const double spacing = set.spacing();
  const double flattest = residuals.scatter(kFalseAlarms);
  // Shape lifts the residuals of fewer points less, to at most 0.48 of the others, noise as much, to at least 0.56.
  if (flattest < kLeastNoise * spacing || Residuals(set, kClosest).scatter(kFalseAlarms) < kClearlyLess * residuals.scatter(kFlat))
    return 0;
  const double filled = flattest / (kSaturation * spacing);
  if (shows_no_noise(set)) return 0;
  const double layered = layered_noise(set);
  // 1 / x^2 = 1 / sigma^2 + 1 / saturation^2
  const double sigma = filled > kFilled ? layered : std::min(layered, flattest / std::sqrt(1 - filled * filled));
  return sigma < kLeastNoise * spacing ? 0 : sigma;
}

// Whether a plane is that of a facet, among four times as many points as it was found among: they are on it or well away, on other facets.
// Those of a bend are as many from w to 2 w away as up to w, as heights over a plane grow with the square of the distance, and at least
// sqrt(2) - 1 times as many, over a cylinder.
bool is_of_facet(const PointSet& set, const ExactPlane& plane, double scatter) {
  const std::vector<Vec3>& points = set.points();
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  set.tree().nearest(points[plane.points.front()], kWallNeighbours, index, squared);
  Vec3 middle{0, 0, 0};
  for (const std::uint32_t i : plane.points)
    middle = vector::add(middle, vector::scale(points[i], 1 / static_cast<double>(plane.points.size())));
  const auto held_within = [&](double distance) {
    return static_cast<double>(std::count_if(index.begin(), index.end(), [&](std::uint32_t i) {
      return std::abs(vector::dot(plane.normal, vector::subtract(points[i], middle))) <= distance;
    }));
  };
  const double held = held_within(kSigmas * scatter);
  return held_within(2 * kSigmas * scatter) - held <= kClearlyLess * kClearlyLess * held;
}

// rounding_deviation() of these steps.
double deviation_of(const Vec3& steps, double spacing) {
  if (std::min({steps[0], steps[1], steps[2]}) == 0) return 0;
  const double sigma = std::hypot(steps[0], steps[1], steps[2]) * std::sqrt(kRoundingVariance / 3);
  return sigma > kLeastNoise * spacing ? sigma : 0;
}

}  // namespace

Vec3 rounding_steps(const std::vector<Vec3>& points, double spacing) {
  Vec3 steps{0, 0, 0};
  std::vector<double> sorted(points.size());
  for (std::size_t a = 0; a < 3; ++a) {
    std::transform(points.begin(), points.end(), sorted.begin(), [&](const Vec3& p) { return p[a]; });
    parallel::sort(sorted.begin(), sorted.end(), std::less<>());
    double least = std::numeric_limits<double>::infinity();
    std::size_t levels = 1;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      const double step = sorted[i] - sorted[i - 1];
      if (step <= kExactScatter * spacing) continue;
      least = std::min(least, step);
      ++levels;
    }
    if (least > kLeastNoise * spacing && levels >= kFewestLevels) steps[a] = least;
  }
  return steps;
}

double rounding_deviation(const PointSet& set) { return deviation_of(set.rounding_steps(), set.spacing()); }

double rounding_noise(const PointSet& set) {
  const Vec3 steps = set.rounding_steps();
  const double sigma = deviation_of(steps, set.spacing());
  if (sigma == 0) return 0;
  std::vector<Vec3> cubes;
  for (const Vec3& p : set.points()) cubes.push_back({p[0] / steps[0], p[1] / steps[1], p[2] / steps[2]});
  const double scatter = Residuals(PointSet(std::move(cubes)), kPatchNeighbours).scatter(0.5);
  return scatter > kClearlyLess * std::sqrt(kRoundingVariance) ? sigma : 0;
}

double estimate_noise(const PointSet& set) {
  if (set.size() < kFewestSurfacePoints) return 0;
  const Residuals residuals(set, kPatchNeighbours);
  return std::max(scattered_noise(set, residuals), rounding_noise(set));
}

double fine_noise(const PointSet& set) {
  if (set.size() < kFewestSurfacePoints) return 0;
  const double spacing = set.spacing();
  const Residuals residuals(set, kPatchNeighbours);
  const double flattest = residuals.scatter(kFalseAlarms);
  if (flattest <= kExactScatter * spacing || flattest >= kWider * kLeastNoise * spacing) return 0;
  // Noise is as large among three times as many points, shape clearly larger.
  const bool is_shape = kWider * Residuals(set, kClosest).scatter(0.5) <= Residuals(set, kTwoPatches).scatter(0.5);
  return is_shape || on_exact_planes(set) ? 0 : flattest;
}

double largest_scatter(const PointSet& set) {
  const double spacing = set.spacing();
  if (set.size() < kFewestSurfacePoints || shows_no_noise(set)) return 0;
  const double x = Residuals(set, kPatchNeighbours).scatter(kMostOf);
  const double filled = std::min(x / (kSaturation * spacing), 1 - kFalseAlarms);  // the law has a pole at 1
  return x / std::sqrt(1 - filled * filled * filled * filled);
}

double facet_scatter(const PointSet& set) {
  if (set.size() < kFewestSurfacePoints) return 0;
  const double spacing = set.spacing();
  const std::vector<double> scatters = at_some(set, kFewPlaces, kPlaneNeighbours, [&](const Vec3&, const auto& index, const auto&) {
    return find_likeliest_plane(set.points(), index, spacing,
                                [&](const LikeliestPlane& found) {
                                  return !is_along_sight(set, index.front(), found.plane.normal) &&
                                         is_of_facet(set, found.plane, found.scatter * spacing);
                                })
        .scatter;
  });
  std::map<double, std::size_t> counts;  // in steps of kLevelRatio
  for (const double s : scatters) {
    if (s > 0) ++counts[s];
  }
  std::size_t most = 0;
  double scatter = 0;
  for (auto step = counts.begin(); step != counts.end(); ++step) {
    const auto next = std::next(step);
    const bool adjacent = next != counts.end() && next->first == kLevelRatio * step->first;
    const std::size_t both = step->second + (adjacent ? next->second : 0);
    if (both <= most) continue;
    most = both;
    scatter = adjacent && next->second > step->second ? next->first : step->first;
  }
  return !are_many(share_of(most, scatters.size())) || scatter <= kExactScatter ? 0 : scatter * spacing;
}

double dimension(const PointSet& set) {
  if (set.size() < kFewestSurfacePoints) return 2;
  const std::size_t far = std::min(kTwiceAsFar * kLayerNeighbours, set.size() / kSmallPart);
  const std::size_t near = far / kTwiceAsFar;
  const double times = std::log(static_cast<double>(far) / static_cast<double>(near));
  // The first of a point's nearest is the point itself.
  std::vector<double> found = at_some(set, kFewPlaces, far + 1, [&](const Vec3&, const auto&, const std::vector<double>& squared) {
    const double ratio = squared[far] / squared[near];
    return ratio > 1 ? 2 * times / std::log(ratio) : 0.0;
  });
  found.erase(std::remove(found.begin(), found.end(), 0.0), found.end());
  return found.empty() ? 2 : quantile(std::move(found), 0.5);
}

}  // namespace g3r
