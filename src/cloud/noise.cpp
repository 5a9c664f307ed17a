#include "cloud/noise.h"

#include "cloud/layers.h"
#include "cloud/plane_fit.h"
#include "cloud/sheet.h"
#include "cloud/spacing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace g3r {
namespace {

constexpr std::size_t kProbes = 2000;      // neighbourhoods looked at, spread along the canonical order
constexpr std::size_t kNeighbours = 32;    // of each, nearest first
constexpr std::size_t kClean = 12;         // nearest ones that tell noise from none
constexpr std::size_t kSmall = 16;         // nearest ones that seldom reach across a wall
constexpr std::size_t kSheets = 24;        // nearest ones whose kurtosis is taken
constexpr double kFlattest = 0.02;         // share of the neighbourhoods that decides
constexpr double kCleanResidual = 0.02;    // in spacings, of planes: below it is clean
constexpr double kCleanQuadratic = 0.022;  // in spacings, of height fields through kSmall points, which curvature does not lift
constexpr double kNoisyResidual = 0.08;    // in spacings, of planes, from where it is noise whatever the height fields say
constexpr double kFlatKurtosis = 0.1;      // share of neighbourhoods whose kurtosis decides
constexpr double kSheetKurtosis = 1.85;    // of that quantile: 1.94 to 2.1 under Gaussian noise, 1.1 to 1.8 between sheets and on wires
constexpr double kSmallToLarge = 1.27;     // residual of 32 neighbours to that of 16 on a noisy plane, while both are small
constexpr double kSmallSaturation = 0.47;  // residual of 16 neighbours, in spacings, when noise fills the ball
constexpr double kSaturationPower = 8;     // how late the ratio of the two leaves kSmallToLarge
constexpr double kLeastRoom = 0.1;         // of 1 - (x / saturation)^power: beyond, the small neighbourhoods bound nothing
constexpr double kSigmaIntercept = 0.842;  // of x / sigma as a line in x, fitted to known noise of 0.1 to 0.8 h
constexpr double kSigmaSlope = 0.372;
constexpr double kLargestResidual = 0.62;      // beyond, the ball is full of noise and tells no more
constexpr std::size_t kLayerProbes = 500;      // neighbourhoods that may hold several sheets
constexpr std::size_t kLayerNeighbours = 256;  // of each
constexpr double kLayerShare = 0.1;            // share of these neighbourhoods that decides: at the others are folds, edges, a third wall
constexpr double kLayerBias = 0.92;            // sigma at that share, of smooth surfaces, over the true one
constexpr double kResolved = 1.0;              // in spacings: larger noise fills these neighbourhoods, too
constexpr std::size_t kThinning = 4;           // then every fourth point has neighbourhoods twice as large
constexpr std::size_t kFewestThinned = 4000;   // left by it; of fewer, 256 points are no small part of the shape
constexpr std::size_t kFewestPoints = 200;     // below, neighbourhoods are a large part of the shape

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Calls visit(point, its `count` nearest, their squared distances) for about `probes` points, spread along their order.
template <typename Visit>
void for_some(const std::vector<Vec3>& points, const Neighbours& neighbours, std::size_t probes, std::size_t count, Visit visit) {
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / probes)) {
    neighbours.nearest(points[i], count, index, squared);
    visit(points[i], index, squared);
  }
}

// Standard deviation about sheets, of which a neighbourhood may hold up to three.
double layered_noise(const std::vector<Vec3>& points, const Neighbours& neighbours, double spacing) {
  std::vector<double> sigma;
  for_some(points, neighbours, kLayerProbes, kLayerNeighbours, [&](const Vec3& point, const auto& index, const auto&) {
    const Vec3 normal = fit_plane(points, index.data(), index.size()).normal;
    sigma.push_back(layered_deviation(points, index.data(), index.size(), point, normal));
  });
  const double found = quantile(sigma, kLayerShare) / kLayerBias;
  if (found < kResolved * spacing || points.size() < kThinning * kFewestThinned) return found;
  std::vector<Vec3> thinned;
  for (std::size_t i = 0; i < points.size(); i += kThinning) thinned.push_back(points[i]);
  return layered_noise(thinned, Neighbours(thinned), typical_spacing(local_spacing(thinned)));
}

// By how the planes through 16 and 32 neighbours miss them; infinite where noise fills their ball.
double small_noise(double x16, double x32) {
  const double expected = kSmallToLarge * x16 / std::max(1 - std::pow(x16 / kSmallSaturation, kSaturationPower), kLeastRoom);
  const double x = std::min(x32, expected);
  return x > kLargestResidual ? std::numeric_limits<double>::infinity() : x / (kSigmaIntercept - kSigmaSlope * x);
}

}  // namespace

double estimate_noise(const std::vector<Vec3>& points, const Neighbours& neighbours, double spacing) {
  if (points.size() < kFewestPoints) return 0;
  std::vector<double> clean;
  std::vector<double> small;
  std::vector<double> large;
  std::vector<double> quadratic;
  std::vector<double> kurtosis;
  for_some(points, neighbours, kProbes, kNeighbours, [&](const Vec3&, const auto& index, const auto&) {
    clean.push_back(fit_plane(points, index.data(), kClean).residual);
    const PlaneFit plane = fit_plane(points, index.data(), kSmall);
    small.push_back(plane.residual);
    quadratic.push_back(quadratic_residual(points, index.data(), kSmall, plane.normal, spacing));
    kurtosis.push_back(fit_plane(points, index.data(), kSheets).kurtosis);
    large.push_back(fit_plane(points, index.data(), kNeighbours).residual);
  });
  const double flattest = quantile(clean, kFlattest) / spacing;
  const bool smooth = quantile(quadratic, kFlattest) < kCleanQuadratic * spacing;
  if (flattest < (smooth ? kNoisyResidual : kCleanResidual) || quantile(kurtosis, kFlatKurtosis) < kSheetKurtosis) return 0;
  const double resolved = spacing * small_noise(quantile(small, kFlattest) / spacing, quantile(large, kFlattest) / spacing);
  return std::min(resolved, layered_noise(points, neighbours, spacing));
}

double dimension(const std::vector<Vec3>& points, const Neighbours& neighbours) {
  constexpr std::size_t kMost = 2048, kShare = 16, kRatio = 8;
  if (points.size() < kFewestPoints) return 2;
  const std::size_t far = std::min(kMost, points.size() / kShare);
  std::vector<double> found;
  for_some(points, neighbours, kLayerProbes, far, [&](const Vec3&, const auto&, const std::vector<double>& squared) {
    const double ratio = squared.back() / squared[far / kRatio];
    if (ratio > 1) found.push_back(2 * std::log(kRatio) / std::log(ratio));
  });
  return found.empty() ? 2 : quantile(std::move(found), 0.5);
}

}  // namespace g3r
