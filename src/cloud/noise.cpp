#include "cloud/noise.h"

#include "cloud/point_tree.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

constexpr std::size_t kFewNeighbours = 16;
constexpr std::size_t kManyNeighbours = 32;
constexpr std::size_t kProbes = 2000;    // neighbourhoods looked at, spread along the canonical order
constexpr double kFlattest = 0.02;       // share of them that decides
constexpr double kCleanResidual = 0.1;   // in spacings
constexpr double kFlatKurtosis = 0.1;    // share of neighbourhoods whose kurtosis decides
constexpr double kSheetKurtosis = 1.96;  // of that quantile: 2.0 to 2.1 under Gaussian noise, 1.1 to 1.9 between sheets and on wires
constexpr double kResidualToSigma = 0.95;
constexpr double kLargestResidual = 0.8;    // beyond, the ball is full of noise and tells no more
constexpr std::size_t kFewestPoints = 200;  // below, neighbourhoods are a large part of the shape

// Plane fit to the nearest neighbours of one point.
struct PlaneFit {
  double residual;  // root mean square distance, corrected for the 3 parameters
  double kurtosis;  // of the distances: 3 for a Gaussian (less, from few points), 1 for two sheets
};

PlaneFit fit_plane(const std::vector<Vec3>& points, const PointTree& tree, const Vec3& at, std::size_t neighbours) {
  std::vector<std::uint32_t> index(neighbours);
  std::vector<double> squared(neighbours);
  const std::size_t found = tree.knnSearch(at.data(), neighbours, index.data(), squared.data());
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

double estimate_noise(const std::vector<Vec3>& points, double spacing) {
  if (points.size() < kFewestPoints) return 0;
  const PointSet set{points};
  const PointTree tree(3, set, nanoflann::KDTreeSingleIndexAdaptorParams(kPointTreeLeaf));
  std::vector<double> few;
  std::vector<double> many;
  std::vector<double> kurtosis;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / kProbes)) {
    few.push_back(fit_plane(points, tree, points[i], kFewNeighbours).residual);
    const PlaneFit wide = fit_plane(points, tree, points[i], kManyNeighbours);
    many.push_back(wide.residual);
    kurtosis.push_back(wide.kurtosis);
  }
  const bool clean = quantile(few, kFlattest) < kCleanResidual * spacing;
  const bool sheets = quantile(kurtosis, kFlatKurtosis) < kSheetKurtosis;
  if (clean || sheets) return 0;
  const double x = std::min(quantile(many, kFlattest) / spacing, kLargestResidual);
  return kResidualToSigma * spacing * x / (1 - x);
}

}  // namespace g3r
