#include "cloud/noise.h"

#include <Eigen/Eigenvalues>

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
constexpr double kCleanResidual = 0.08;    // in spacings; clean models stay below 0.014, noise of 0.1 % of the diagonal gives 0.09
constexpr double kFlatKurtosis = 0.1;      // share of neighbourhoods whose kurtosis decides
constexpr double kSheetKurtosis = 1.85;    // of that quantile: 1.94 to 2.1 under Gaussian noise, 1.1 to 1.8 between sheets and on wires
constexpr double kSmallToLarge = 1.27;     // residual of 32 neighbours to that of 16 on a noisy plane, while both are small
constexpr double kSmallSaturation = 0.47;  // residual of 16 neighbours, in spacings, when noise fills the ball
constexpr double kSaturationPower = 8;     // how late the ratio of the two leaves kSmallToLarge
constexpr double kLeastRoom = 0.1;         // of 1 - (x / saturation)^power: beyond, the small neighbourhoods bound nothing
constexpr double kResidualToSigma = 0.95;
constexpr double kLargestResidual = 0.8;    // beyond, the ball is full of noise and tells no more
constexpr std::size_t kFewestPoints = 200;  // below, neighbourhoods are a large part of the shape

// Plane fit to the nearest neighbours of one point.
struct PlaneFit {
  double residual;  // root mean square distance, corrected for the 3 parameters
  double kurtosis;  // of the distances: 3 for a Gaussian (less, from few points), 1 for two sheets
};

// To the first `found` of `index`.
PlaneFit fit_plane(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t found) {
  const auto count = static_cast<double>(found);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < found; ++k) mean += Eigen::Map<const Eigen::Vector3d>(points[index[k]].data()) / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < found; ++k) {
    const Eigen::Vector3d d = Eigen::Map<const Eigen::Vector3d>(points[index[k]].data()) - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
  double second = 0;
  double fourth = 0;
  for (std::size_t k = 0; k < found; ++k) {
    const double t = normal.dot(Eigen::Map<const Eigen::Vector3d>(points[index[k]].data()) - mean);
    second += t * t;
    fourth += t * t * t * t;
  }
  return {std::sqrt(std::max(0.0, eigen.eigenvalues()[0]) / (count - 3)), second > 0 ? count * fourth / (second * second) : 0};
}

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
  std::vector<double> kurtosis;
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / kProbes)) {
    neighbours.nearest(points[i], kNeighbours, index, squared);
    clean.push_back(fit_plane(points, index.data(), kClean).residual);
    small.push_back(fit_plane(points, index.data(), kSmall).residual);
    kurtosis.push_back(fit_plane(points, index.data(), kSheets).kurtosis);
    large.push_back(fit_plane(points, index.data(), kNeighbours).residual);
  }
  if (quantile(clean, kFlattest) < kCleanResidual * spacing || quantile(kurtosis, kFlatKurtosis) < kSheetKurtosis) return 0;
  const double x16 = quantile(small, kFlattest) / spacing;
  const double expected = kSmallToLarge * x16 / std::max(1 - std::pow(x16 / kSmallSaturation, kSaturationPower), kLeastRoom);
  const double x = std::min({quantile(large, kFlattest) / spacing, expected, kLargestResidual});
  return kResidualToSigma * spacing * x / (1 - x);
}

}  // namespace g3r
