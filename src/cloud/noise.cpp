#include "cloud/noise.h"

#include "cloud/plane_fit.h"
#include "cloud/sheet.h"

#include <algorithm>
#include <cmath>

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
constexpr double kResidualToSigma = 0.95;
constexpr double kLargestResidual = 0.8;    // beyond, the ball is full of noise and tells no more
constexpr std::size_t kFewestPoints = 200;  // below, neighbourhoods are a large part of the shape

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double estimate_noise(const std::vector<Vec3>& points, const Neighbours& neighbours, double spacing) {
  if (points.size() < kFewestPoints) return 0;
  std::vector<double> clean;
  std::vector<double> small;
  std::vector<double> large;
  std::vector<double> quadratic;
  std::vector<double> kurtosis;
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / kProbes)) {
    neighbours.nearest(points[i], kNeighbours, index, squared);
    clean.push_back(fit_plane(points, index.data(), kClean).residual);
    const PlaneFit plane = fit_plane(points, index.data(), kSmall);
    small.push_back(plane.residual);
    quadratic.push_back(quadratic_residual(points, index.data(), kSmall, plane.normal, spacing));
    kurtosis.push_back(fit_plane(points, index.data(), kSheets).kurtosis);
    large.push_back(fit_plane(points, index.data(), kNeighbours).residual);
  }
  const double flattest = quantile(clean, kFlattest) / spacing;
  const bool smooth = quantile(quadratic, kFlattest) < kCleanQuadratic * spacing;
  if (flattest < (smooth ? kNoisyResidual : kCleanResidual) || quantile(kurtosis, kFlatKurtosis) < kSheetKurtosis) return 0;
  const double x16 = quantile(small, kFlattest) / spacing;
  const double expected = kSmallToLarge * x16 / std::max(1 - std::pow(x16 / kSmallSaturation, kSaturationPower), kLeastRoom);
  const double x = std::min({quantile(large, kFlattest) / spacing, expected, kLargestResidual});
  return kResidualToSigma * spacing * x / (1 - x);
}

}  // namespace g3r
