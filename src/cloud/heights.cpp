#include "cloud/heights.h"

#include "base/median.h"
#include "cloud/constants.h"
#include "cloud/noise.h"
#include "cloud/quadratic_patch.h"
#include "cloud/sites.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace g3r {
namespace {

constexpr Eigen::Index kColumns = kCubicTerms;
// Columns keep this share of their squares beside those to their left: the ridge leaves 1 to 6 of itself where points on a line or a conic
// determine them, and random points and grids keep 1e4 times as much.
constexpr double kLeastOwn = 10 * kRidge;

// Of the kurtosis, where two walls are so many standard deviations apart.
double excess_of_walls(double apart) { return -2 * std::pow(apart * apart / (apart * apart + 4), 2); }

// Columns 1 and 2 are the places across the normal, and whitened^T whitened is what the fit takes.
double correlation_of_adjacent(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& whitened, const Eigen::VectorXd& residual) {
  const Eigen::Index n = residual.size();
  const double square = residual.squaredNorm();
  const double variance = square / static_cast<double>(n - kColumns);
  double sum = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::ArrayXd squared = (columns.col(1).array() - columns(k, 1)).square() + (columns.col(2).array() - columns(k, 2)).square();
    squared[k] = HUGE_VAL;
    Eigen::Index nearest = 0;
    squared.minCoeff(&nearest);
    sum += residual[k] * residual[nearest] + variance * whitened.col(k).dot(whitened.col(nearest));
  }
  return sum / square;
}

}  // namespace

HeightMoments height_moments(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal, double h,
                             const Vec3& steps) {
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
  if (!((factors.matrixLLT().diagonal().array().square() / normal_equations.diagonal().array()).minCoeff() > kLeastOwn)) return {};
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
  moments.correlation = correlation_of_adjacent(columns, whitened, residual);
  double rounding = 0;  // fourth cumulant
  for (std::size_t a = 0; a < 3; ++a) rounding += kRoundingCumulant * std::pow(normal[a] * steps[a], 4);
  if (rounding != 0) moments.excess -= rounding / (moments.mean_square * moments.mean_square);
  return moments;
}

double MeanExcess::of_shape() const { return -2 * std::pow(std::max(0.0, correlation), 2); }

bool MeanExcess::may_be_two_walls() const { return mean < of_shape() + excess_of_walls(kWider); }

bool MeanExcess::is_two_walls() const { return may_be_two_walls() && mean < of_shape() - kSigmas * error; }

MeanExcess mean_excess(const std::vector<HeightMoments>& places, double disjoint) {
  if (places.size() < kFewestSites) return {};
  std::vector<double> squares;
  for (const HeightMoments& m : places) squares.push_back(m.mean_square);
  const double flat = median(std::move(squares));
  double sum = 0;
  double sum_of_squares = 0;
  double correlation = 0;
  double count = 0;
  for (const HeightMoments& m : places) {
    if (m.mean_square > flat) continue;
    sum += m.excess;
    correlation += m.correlation;
    sum_of_squares += m.excess * m.excess;
    ++count;
  }
  const double mean = sum / count;
  const double variance = std::max(0.0, sum_of_squares - count * mean * mean) / (count - 1);
  const double independent = count * std::min(1.0, disjoint / static_cast<double>(places.size()));
  return {mean, std::sqrt(variance / independent), correlation / count};
}

}  // namespace g3r
