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

constexpr std::size_t kProbes = 2000;      // neighbourhoods looked at, spread along the canonical order
constexpr std::size_t kNeighbours = 32;    // of each, nearest first
constexpr std::size_t kClean = 12;         // nearest ones that distinguish noise from none
constexpr std::size_t kSmall = 16;         // nearest ones that seldom reach across a wall
constexpr std::size_t kInLayers = 24;      // nearest ones whose kurtosis is taken
constexpr double kFlattest = 0.02;         // share of the neighbourhoods that decides
constexpr double kCleanResidual = 0.02;    // in spacings, of planes: below it is clean
constexpr double kCleanQuadratic = 0.017;  // in spacings, of height fields through kClean points, which curvature does not lift
constexpr double kUnevenQuadratic = 0.04;  // the same where the other neighbourhoods are lifted far more: by shape, then
constexpr double kUneven = 0.15;           // of the median of the height fields' residuals, that of the flattest: 0.25 or more under noise
constexpr double kFlatKurtosis = 0.1;      // share of neighbourhoods whose kurtosis decides
constexpr double kLayerKurtosis = 1.85;    // of that quantile: 1.94 to 2.1 under Gaussian noise, 1.1 to 1.8 between layers and on wires
constexpr double kOnPlanes = 0.4;          // share of the points on one exact plane that shows a cloud to be clean
constexpr std::size_t kWide = 64;          // nearest ones whose plane is the surface's wherever that is not folded
constexpr double kAlong = 0.5;             // cosine from which an exact plane lies along the surface
constexpr double kMostlyAlong = 0.25;      // least share of the exact planes that do: none of those of scan lines
constexpr double kBetweenLayers = 0.005;   // share of neighbourhoods with two layers that does: none in a thousand under noise
constexpr std::size_t kFewestBetween = 5;  // such neighbourhoods
constexpr std::size_t kFewInLayers = 16;   // nearest ones on two layers, of which those take a smaller share of the gap
constexpr double kFewApart = 0.08;         // of the gap, the deviation from layers through kFewInLayers
constexpr double kApart = 0.12;            // and through kInLayers
constexpr double kOnLayer = 0.05;          // in spacings, that deviation
constexpr double kRounded = 0.05;          // in spacings, steps of coordinates that put noisy points on planes
constexpr double kLeastRounding = 0.04;    // spacings, of the deviation that rounding leaves; less is no noise
constexpr std::size_t kFewestLevels = 5;   // values of a rounded coordinate; those of plates and boxes that stand straight are fewer
constexpr double kTerraces = 0.5;          // of the deviation that rounding leaves, the median residual of height fields from which it does
constexpr double kSameCoordinate = 1e-4;   // in spacings, between coordinates that differ by rounding only
constexpr double kSmallToLarge = 1.27;     // residual of 32 neighbours to that of 16 on a noisy plane, while both are small
constexpr double kSmallSaturation = 0.47;  // residual of 16 neighbours, in spacings, when noise fills the ball
constexpr double kSaturationPower = 8;     // how late the ratio of the two leaves kSmallToLarge
constexpr double kLeastRoom = 0.1;         // of 1 - (x / saturation)^power: beyond, the small neighbourhoods bound nothing
constexpr double kSigmaIntercept = 0.842;  // of x / sigma as a line in x, fitted to known noise of 0.1 to 0.8 h
constexpr double kSigmaSlope = 0.372;
constexpr double kLargestResidual = 0.62;              // beyond, the ball is full of noise and tells no more
constexpr std::size_t kLayerProbes = 500;              // neighbourhoods that may hold several layers
constexpr std::size_t kLayerNeighbours = 256;          // of each
constexpr std::size_t kGoesOn = 4 * kPlaneNeighbours;  // points among which the plane of a facet goes on: 13 spacings across
constexpr double kHeld = 3.5;                          // standard deviations that these may be off it: its tilt adds one so far out
constexpr double kLayerShare = 0.1;            // share of these neighbourhoods that decides: at the others are folds, edges, a third wall
constexpr double kLayerBias = 0.92;            // sigma at that share, of smooth surfaces, over the true one
constexpr double kMostScattered = 0.75;        // quantile of the neighbourhoods that stands for those with the largest noise
constexpr double kQuadraticToSigma = 1.12;     // that quantile of the residuals of height fields over sigma, while both are small
constexpr double kQuadraticSaturation = 0.64;  // in spacings, that quantile when noise fills the balls
constexpr double kLargestQuadratic = 0.62;     // beyond, it tells no more
constexpr double kResolved = 1.0;              // in spacings: larger noise fills these neighbourhoods, too
constexpr std::size_t kThinning = 4;           // then every fourth point has neighbourhoods twice as large
constexpr std::size_t kFewestThinned = 4000;   // left by it; of fewer, 256 points are no small part of the shape
constexpr std::size_t kFewestPoints = 200;     // below, neighbourhoods are a large part of the shape

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

// Of some neighbourhoods, how far their points are from simple surfaces.
struct Residuals {
  std::vector<double> clean, small, large;  // planes through kClean, kSmall, kNeighbours points
  std::vector<double> quadratic;            // height fields through kClean
  std::vector<double> kurtosis;             // about the planes through kInLayers
};

Residuals residuals_of(const PointSet& set) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  Residuals r;
  for_some(set, kProbes, kNeighbours, [&](const Vec3&, const auto& index, const auto&) {
    const PlaneFit plane = fit_plane(points, index.data(), kClean);
    r.clean.push_back(plane.residual);
    r.quadratic.push_back(quadratic_residual(points, index.data(), kClean, plane.normal, spacing));
    r.small.push_back(fit_plane(points, index.data(), kSmall).residual);
    r.kurtosis.push_back(fit_plane(points, index.data(), kInLayers).kurtosis);
    r.large.push_back(fit_plane(points, index.data(), kNeighbours).residual);
  });
  return r;
}

// Standard deviation about layers, of which a neighbourhood may hold up to three.
double layered_noise(const PointSet& set) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  std::vector<double> sigma;
  for_some(set, kLayerProbes, kLayerNeighbours, [&](const Vec3& point, const auto& index, const auto&) {
    const Vec3 normal = fit_plane(points, index.data(), index.size()).normal;
    sigma.push_back(layered_deviation(points, index.data(), index.size(), point, normal));
  });
  const double found = quantile(sigma, kLayerShare) / kLayerBias;
  if (found < kResolved * spacing || points.size() < kThinning * kFewestThinned) return found;
  std::vector<Vec3> thinned;
  for (std::size_t i = 0; i < points.size(); i += kThinning) thinned.push_back(points[i]);
  return layered_noise(PointSet(std::move(thinned)));
}

// By how the planes through 16 and 32 neighbours miss them; infinite where noise fills their ball.
double small_noise(double x16, double x32) {
  const double expected = kSmallToLarge * x16 / std::max(1 - std::pow(x16 / kSmallSaturation, kSaturationPower), kLeastRoom);
  const double x = std::min(x32, expected);
  return x > kLargestResidual ? std::numeric_limits<double>::infinity() : x / (kSigmaIntercept - kSigmaSlope * x);
}

bool rounded(const std::vector<Vec3>& points, double spacing) {
  const Vec3 steps = rounding_steps(points, spacing);
  return std::max({steps[0], steps[1], steps[2]}) > 0;
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

bool between_layers(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, std::size_t count, double share,
                    double spacing) {
  const Vec3 normal = fit_plane(points, index.data(), count).normal;
  const TwoLayers layers = fit_two_layers(points, index.data(), count, normal);
  return layers.deviation < std::min(share * layers.gap, kOnLayer * spacing);
}

// Whether many of the points lie on exact planes along the surface.
bool on_exact_planes(const PointSet& set) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  std::size_t looked = 0, on_facets = 0, along = 0;
  std::vector<std::uint32_t> wide;
  std::vector<double> squared;
  for_some(set, kProbes, kPlaneNeighbours, [&](const Vec3& point, const auto& index, const auto&) {
    ++looked;
    const ExactPlane facet = find_facet(points, index, spacing);
    if (facet.breadth == 0) return;
    set.tree().nearest(point, kWide, wide, squared);
    ++on_facets;
    along += std::abs(vector::dot(facet.normal, fit_plane(points, wide.data(), wide.size()).normal)) > kAlong ? 1 : 0;
  });
  return share_of(on_facets, looked) >= kOnPlanes && share_of(along, on_facets) >= kMostlyAlong;
}

// Whether some of the points lie on two curved layers without scatter, as those of thin walls and narrow gaps do.
bool on_exact_layers(const PointSet& set) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  std::size_t looked = 0, between = 0;
  for_some(set, kProbes, kInLayers, [&](const Vec3&, const auto& index, const auto&) {
    ++looked;
    if (between_layers(points, index, kFewInLayers, kFewApart, spacing) || between_layers(points, index, kInLayers, kApart, spacing))
      ++between;
  });
  return between >= kFewestBetween && share_of(between, looked) >= kBetweenLayers;
}

// Standard deviation of what rounding all three coordinates leaves, 0 if it leaves none: a box may well have integer coordinates.
double rounding_noise(const PointSet& set, const Residuals& residuals) {
  const double spacing = set.spacing();
  const Vec3 steps = rounding_steps(set.points(), spacing);
  if (std::min({steps[0], steps[1], steps[2]}) == 0) return 0;
  const double sigma = std::hypot(steps[0], steps[1], steps[2]) / std::sqrt(3 * 12);
  return sigma > kLeastRounding * spacing && quantile(residuals.quadratic, 0.5) > kTerraces * sigma ? sigma : 0;
}

// By the flattest neighbourhoods, 0 where these or exact surfaces show that there is none.
double scattered_noise(const PointSet& set, const Residuals& residuals) {
  const double spacing = set.spacing();
  const double curved = quantile(residuals.quadratic, kFlattest);
  const bool uneven = curved < kUnevenQuadratic * spacing && curved < kUneven * quantile(residuals.quadratic, 0.5);
  if (quantile(residuals.clean, kFlattest) < kCleanResidual * spacing || curved < kCleanQuadratic * spacing || uneven) return 0;
  if (quantile(residuals.kurtosis, kFlatKurtosis) < kLayerKurtosis) return 0;
  const bool exact = on_exact_planes(set) || on_exact_layers(set);
  if (exact && !rounded(set.points(), spacing)) return 0;
  const double x16 = quantile(residuals.small, kFlattest) / spacing;
  const double x32 = quantile(residuals.large, kFlattest) / spacing;
  return std::min(spacing * small_noise(x16, x32), layered_noise(set));
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
    if (least > kRounded * spacing && levels >= kFewestLevels) steps[a] = least;
  }
  return steps;
}

double estimate_noise(const PointSet& set) {
  if (set.size() < kFewestPoints) return 0;
  const Residuals residuals = residuals_of(set);
  return std::max(scattered_noise(set, residuals), rounding_noise(set, residuals));
}

double largest_scatter(const PointSet& set) {
  const double spacing = set.spacing();
  if (set.size() < kFewestPoints || (on_exact_planes(set) && !rounded(set.points(), spacing))) return 0;
  const double x = quantile(residuals_of(set).quadratic, kMostScattered) / spacing;
  const double filled = std::min(x, kLargestQuadratic) / kQuadraticSaturation;
  return spacing * x / (kQuadraticToSigma * std::sqrt(1 - filled * filled * filled * filled));
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
