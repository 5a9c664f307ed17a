#include "cloud/plane_fit.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace g3r {

PlaneFit fit_plane(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count) {
  using Eigen::Vector3d;
  const auto position = [&](std::size_t k) { return Eigen::Map<const Vector3d>(points[index[k]].data()); };
  const auto total = static_cast<double>(count);
  Vector3d mean = Vector3d::Zero();
  for (std::size_t k = 0; k < count; ++k) mean += position(k) / total;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3d d = position(k) - mean;
    spread += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(spread);
  const Vector3d normal = eigen.eigenvectors().col(0);
  double second = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double t = normal.dot(position(k) - mean);
    second += t * t;
  }
  PlaneFit fit;
  fit.normal = {normal[0], normal[1], normal[2]};
  fit.residual = std::sqrt(second / (total - kPlaneTerms));
  fit.flatness = eigen.eigenvalues()[1] > 0 ? std::sqrt(second / eigen.eigenvalues()[1]) : 1;
  fit.breadth = eigen.eigenvalues()[2] > 0 ? std::sqrt(std::max(0.0, eigen.eigenvalues()[1]) / eigen.eigenvalues()[2]) : 0;
  return fit;
}

}  // namespace g3r
