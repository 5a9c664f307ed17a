#include "cloud/heights.h"

#include "cloud/constants.h"
#include "cloud/quadratic_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <limits>

namespace g3r {
namespace {

constexpr Eigen::Index kColumns = terms_of(3);

}  // namespace

HeightMoments height_moments(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal, double h) {
  const Eigen::Matrix3d frame = tangent_frame(to_eigen(normal));
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < count; ++k) middle += to_eigen(points[index[k]]) / static_cast<double>(count);
  const auto n = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd columns(n, kColumns);
  Eigen::VectorXd heights(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Vector3d q = frame * (to_eigen(points[index[k]]) - middle) / h;
    const double u = q[0], v = q[1];
    columns.row(k) << 1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v;
    heights[k] = q[2];
  }
  Eigen::Matrix<double, kColumns, kColumns> normal_equations = columns.transpose() * columns;
  normal_equations.diagonal() *= 1 + kRidge;
  const Eigen::LLT<Eigen::Matrix<double, kColumns, kColumns>> factors(normal_equations);
  if (factors.info() != Eigen::Success) return {};
  const Eigen::VectorXd residual = heights - columns * factors.solve(columns.transpose() * heights);
  const Eigen::MatrixXd whitened = factors.matrixL().solve(columns.transpose());  // column k has the squared length 1 - M_kk
  const double square = residual.squaredNorm();
  const Eigen::ArrayXd kept = (1 - whitened.colwise().squaredNorm().array()).square();  // M_kk^2
  const auto free = static_cast<double>(n - kColumns);
  HeightMoments moments;
  moments.mean_square = square / free * h * h;
  const double least = std::numeric_limits<double>::min();
  if (!(square * square >= least) || !(kept.square().sum() >= least)) return {};
  moments.excess = residual.array().square().square().sum() / (square * square) * free * (free + 2) - 3 * kept.sum();
  moments.excess /= kept.square().sum();
  return moments;
}

}  // namespace g3r
