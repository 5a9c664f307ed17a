#include "cloud/noise.h"

#include "base/vector.h"
#include "cloud/exact_plane.h"
#include "cloud/layers.h"
#include "cloud/plane_fit.h"
#include "cloud/quadratic_patch.h"
#include "cloud/spacing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

namespace g3r {
namespace {

constexpr std::size_t kProbes = 2000;    // neighbourhoods looked at, spread along the canonical order
constexpr std::size_t kNeighbours = 12;  // of each, to which height fields are fitted; more reach across walls
constexpr std::size_t kFewer = 8;        // nearest of them: shape lifts these less, noise as much
constexpr std::size_t kParameters = 6;   // of a height field
constexpr double kFlattest = 0.02;       // share of the neighbourhoods that decides: shape lifts the others
constexpr double kFlat = 0.1;            // share that shape lifts more than those; that of the layers that decides
constexpr double kShape = 0.5;           // of the scatter of the flat ones, that of the flattest, below which it is shape: 0.56 under noise
constexpr double kLeast = 0.04;          // in spacings, of noise: less blurs nothing, and curvature leaves as much
constexpr double kSaturation = 0.57;     // in spacings, what the flattest say where noise fills their balls
constexpr double kFilled = 0.75;         // of that: beyond, they tell no more
constexpr double kMostScattered = 0.75;  // quantile of the neighbourhoods that stands for those with the largest noise
constexpr double kMostSaturation = 0.56;   // in spacings, what that says where noise fills the balls
constexpr double kMostFilled = 0.97;       // of that: beyond, it tells no more
constexpr double kOnPlanes = 0.4;          // share of the points on one exact plane that shows a cloud to be clean
constexpr double kAlong = 0.5;             // cosine from which it lies along the surface: those of scan lines are across it
constexpr std::size_t kFewestLevels = 5;   // values of a rounded coordinate; those of plates and boxes that stand straight are fewer
constexpr double kTerraces = 0.5;          // of the deviation that rounding leaves, the median residual of height fields from which it does
constexpr double kSameCoordinate = 1e-4;   // in spacings, between coordinates that differ by rounding only
constexpr std::size_t kLayerProbes = 500;  // neighbourhoods that may hold several layers
constexpr std::size_t kLayerNeighbours = 256;          // of each
constexpr double kLayerBias = 0.92;                    // sigma at the share kFlat of them, of smooth surfaces, over the true one
constexpr std::size_t kGoesOn = 4 * kPlaneNeighbours;  // points among which the plane of a facet goes on: 13 spacings across
constexpr double kHeld = 3.5;                          // standard deviations that these may be off it: its tilt adds one so far out
constexpr double kResolved = 1.0;                      // in spacings: larger noise fills the neighbourhoods of layers, too
constexpr std::size_t kThinning = 4;                   // then every fourth point has neighbourhoods twice as large
constexpr std::size_t kFewestThinned = 4000;           // left by it; of fewer, 256 points are no small part of the shape
constexpr std::size_t kFewestPoints = 200;             // below, neighbourhoods are a large part of the shape

double share_of(std::size_t some, std::size_t all) { return static_cast<double>(some) / static_cast<double>(all); }

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Calls visit(point, its `count` nearest, their squared distances) for about `probes` points, spread along their order.
template <typename Visit>
void for_some(const PointSet& set, std::size_t probes, std::size_t count, Visit visit) {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  const std::vector<Vec3>& points = set.points();
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / probes)) {
    set.tree().nearest(points[i], count, index, squared);
    visit(points[i], index, squared);
  }
}

// The residual at this quantile that noise of standard deviation 1 leaves of `count` points, an even number: x with
// P(chi^2 <= d x^2) = share, d = count - kParameters, where P = 1 - e^-y (1 + y + y^2 / 2! + ... + y^(d/2 - 1) / (d/2 - 1)!), y = d x^2
// / 2.
double expected_residual(std::size_t count, double share) {
  const std::size_t half = (count - kParameters) / 2;
  double low = 0, high = 4;
  for (int bit = 0; bit < std::numeric_limits<double>::digits; ++bit) {
    const double x = (low + high) / 2, y = static_cast<double>(half) * x * x;
    double term = 1, sum = 1;
    for (std::size_t k = 1; k < half; ++k) sum += term *= y / static_cast<double>(k);
    (1 - std::exp(-y) * sum < share ? low : high) = x;
  }
  return low;
}

// How far the points are from height fields through `count` of them.
class Residuals {
 public:
  Residuals(const PointSet& set, std::size_t count) : count_(count) {
    const std::vector<Vec3>& points = set.points();
    for_some(set, kProbes, count, [&](const Vec3&, const auto& index, const auto&) {
      const Vec3 normal = fit_plane(points, index.data(), index.size()).normal;
      residuals_.push_back(quadratic_residual(points, index.data(), index.size(), normal, set.spacing()));
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
  std::vector<double> sigma;
  for_some(set, kLayerProbes, kLayerNeighbours, [&](const Vec3& point, const auto& index, const auto&) {
    const Vec3 normal = fit_plane(points, index.data(), index.size()).normal;
    sigma.push_back(layered_deviation(points, index.data(), index.size(), point, normal));
  });
  const double found = quantile(sigma, kFlat) / kLayerBias;
  if (found < kResolved * spacing || points.size() < kThinning * kFewestThinned) return found;
  std::vector<Vec3> thinned;
  for (std::size_t i = 0; i < points.size(); i += kThinning) thinned.push_back(points[i]);
  return layered_noise(PointSet(std::move(thinned)));
}

// The facet that the first of the points is on; none, of breadth 0, where the points may be those of rows: the lines of a raster or a
// scanner lie in planes across the surface however noisy it is, but in narrow strips of them, or there is another plane among the other
// points.
ExactPlane find_facet(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, double spacing) {
  const ExactPlane plane = find_exact_plane(points, index, spacing);
  if (plane.breadth < kFacetBreadth) return {};
  std::vector<std::uint32_t> others{index.front()};
  std::copy_if(index.begin(), index.end(), std::back_inserter(others),
               [&](std::uint32_t i) { return std::find(plane.points.begin(), plane.points.end(), i) == plane.points.end(); });
  return find_exact_plane(points, others, spacing).points.empty() ? plane : ExactPlane{};
}

// Whether many of the points lie on exact planes along the surface, and not because rounding has put them there.
bool on_exact_planes(const PointSet& set) {
  const Vec3 steps = rounding_steps(set.points(), set.spacing());
  if (std::max({steps[0], steps[1], steps[2]}) > 0) return false;
  std::size_t looked = 0, on_facets = 0;
  for_some(set, kProbes, kPlaneNeighbours, [&](const Vec3&, const auto& index, const auto&) {
    ++looked;
    const ExactPlane facet = find_facet(set.points(), index, set.spacing());
    if (facet.breadth == 0) return;
    const Vec3 around = fit_plane(set.points(), index.data(), index.size()).normal;
    on_facets += std::abs(vector::dot(facet.normal, around)) > kAlong ? 1 : 0;
  });
  return share_of(on_facets, looked) >= kOnPlanes;
}

// Standard deviation of what rounding all three coordinates leaves, 0 if it leaves none: a box may well have integer coordinates.
double rounding_noise(const PointSet& set, const Residuals& residuals) {
  const double spacing = set.spacing();
  const Vec3 steps = rounding_steps(set.points(), spacing);
  if (std::min({steps[0], steps[1], steps[2]}) == 0) return 0;
  const double sigma = std::hypot(steps[0], steps[1], steps[2]) / std::sqrt(3 * 12);
  return sigma > kLeast * spacing && residuals.scatter(0.5) > kTerraces * sigma ? sigma : 0;
}

// By the flattest neighbourhoods, 0 where these or exact planes show that there is none.
double scattered_noise(const PointSet& set, const Residuals& residuals) {
  const double spacing = set.spacing();
  const double flattest = residuals.scatter(kFlattest);
  if (flattest < kLeast * spacing || Residuals(set, kFewer).scatter(kFlattest) < kShape * residuals.scatter(kFlat)) return 0;
  const double filled = flattest / (kSaturation * spacing);
  if (on_exact_planes(set)) return 0;
  const double layered = layered_noise(set);
  // 1 / x^2 = 1 / sigma^2 + 1 / saturation^2
  const double sigma = filled > kFilled ? layered : std::min(layered, flattest / std::sqrt(1 - filled * filled));
  return sigma < kLeast * spacing ? 0 : sigma;
}

// Whether a plane goes on among four times as many points as it was found among: that of a facet does, also where half of them are on
// another wall; that of a bend ends.
bool goes_on(const PointSet& set, const ExactPlane& plane, double scatter) {
  const std::vector<Vec3>& points = set.points();
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  set.tree().nearest(points[plane.points.front()], kGoesOn, index, squared);
  Vec3 middle{0, 0, 0};
  for (const std::uint32_t i : plane.points)
    middle = vector::add(middle, vector::scale(points[i], 1 / static_cast<double>(plane.points.size())));
  const auto held = std::count_if(index.begin(), index.end(), [&](std::uint32_t i) {
    return std::abs(vector::dot(plane.normal, vector::subtract(points[i], middle))) <= kHeld * scatter;
  });
  return share_of(static_cast<std::size_t>(held), index.size()) >= kOnPlanes;
}

}  // namespace

Vec3 rounding_steps(const std::vector<Vec3>& points, double spacing) {
  Vec3 steps{0, 0, 0};
  std::vector<double> sorted(points.size());
  for (std::size_t a = 0; a < 3; ++a) {
    std::transform(points.begin(), points.end(), sorted.begin(), [&](const Vec3& p) { return p[a]; });
    std::sort(sorted.begin(), sorted.end());
    double least = std::numeric_limits<double>::infinity();
    std::size_t levels = 1;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      const double step = sorted[i] - sorted[i - 1];
      if (step <= kSameCoordinate * spacing) continue;
      least = std::min(least, step);
      ++levels;
    }
    if (least > kLeast * spacing && levels >= kFewestLevels) steps[a] = least;
  }
  return steps;
}

double estimate_noise(const PointSet& set) {
  if (set.size() < kFewestPoints) return 0;
  const Residuals residuals(set, kNeighbours);
  return std::max(scattered_noise(set, residuals), rounding_noise(set, residuals));
}

double largest_scatter(const PointSet& set) {
  const double spacing = set.spacing();
  if (set.size() < kFewestPoints || on_exact_planes(set)) return 0;
  const double x = Residuals(set, kNeighbours).scatter(kMostScattered);
  const double filled = std::min(x / (kMostSaturation * spacing), kMostFilled);
  return x / std::sqrt(1 - filled * filled * filled * filled);
}

double facet_scatter(const PointSet& set) {
  if (set.size() < kFewestPoints) return 0;
  std::map<double, std::size_t> counts;  // by scatter, in steps of 2
  std::size_t looked = 0;
  for_some(set, kLayerProbes, kPlaneNeighbours, [&](const Vec3&, const auto& index, const auto&) {
    ++looked;
    const LikeliestPlane found = find_likeliest_plane(set.points(), index, set.spacing());
    if (found.scatter > 0 && goes_on(set, found.plane, found.scatter * set.spacing())) ++counts[found.scatter];
  });
  std::size_t most = 0;
  double scatter = 0;
  for (auto step = counts.begin(); step != counts.end(); ++step) {
    const auto next = std::next(step);
    const bool adjacent = next != counts.end() && next->first == 2 * step->first;
    const std::size_t both = step->second + (adjacent ? next->second : 0);
    if (both <= most) continue;
    most = both;
    scatter = adjacent && next->second > step->second ? next->first : step->first;
  }
  return share_of(most, looked) < kOnPlanes || scatter <= kExactScatter ? 0 : scatter * set.spacing();
}

double dimension(const PointSet& set) {
  constexpr std::size_t kMost = 2048, kShare = 16, kRatio = 8;
  if (set.size() < kFewestPoints) return 2;
  const std::size_t far = std::min(kMost, set.size() / kShare);
  std::vector<double> found;
  for_some(set, kLayerProbes, far, [&](const Vec3&, const auto&, const std::vector<double>& squared) {
    const double ratio = squared.back() / squared[far / kRatio];
    if (ratio > 1) found.push_back(2 * std::log(kRatio) / std::log(ratio));
  });
  return found.empty() ? 2 : quantile(std::move(found), 0.5);
}

}  // namespace g3r
