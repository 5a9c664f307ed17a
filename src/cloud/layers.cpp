#include "cloud/layers.h"

#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/noise.h"
#include "cloud/quadratic_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace g3r {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRadius = 0.6;                       // of the cylinder, in distances of the farthest point
constexpr double kTail = 1.5;                         // deviations of a layer that have to be inside for its own deviation to count
constexpr Eigen::Index kTerms = kQuadraticTerms - 1;  // u, v, u^2, u v, v^2
constexpr int kSteps = 20;  // of expectation and maximisation, and of points that look for their layer: most change theirs 4 times
constexpr Eigen::Index kMostLayers = 3;
constexpr int kFewestOnLayer = kPlaneTerms + 1;                  // of two layers, on either: fewer say nothing of their distance
constexpr double kNoShare = std::numeric_limits<double>::min();  // keeps the logarithm of a likelihood finite

struct Heights {
  MatrixXd terms;   // n x kTerms, of order 1
  VectorXd z;       // from the centre
  double most = 0;  // |z| up to which the cylinder is inside the ball of the points
};

struct Mixture {
  double sigma = 0;
  double criterion = 0;  // Bayesian information criterion, but for a constant
};

Heights heights(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre, const Vec3& normal) {
  const Eigen::Matrix3d frame = tangent_frame(to_eigen(normal));
  const double radius = (to_eigen(points[index[count - 1]]) - to_eigen(centre)).norm();
  const auto most = static_cast<Eigen::Index>(count);
  Heights h{MatrixXd(most, kTerms), VectorXd(most), std::sqrt(1 - kRadius * kRadius) * radius};
  Eigen::Index n = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d q = frame * (to_eigen(points[index[k]]) - to_eigen(centre)) / radius;
    const double u = q[0] / kRadius, v = q[1] / kRadius;
    if (u * u + v * v >= 1) continue;
    h.terms.row(n) << u, v, u * u, u * v, v * v;
    h.z[n++] = q[2] * radius;
  }
  h.terms.conservativeResize(n, kTerms);
  h.z.conservativeResize(n);
  return h;
}

// Starts from one layer's fit (`slopes`, `middle`, `deviation`), where equal layers at equal distances, without scatter, have its
// deviation.
template <std::size_t kLayers>
Mixture fit_mixture(const Heights& h, const Eigen::LDLT<MatrixXd>& normal_equations, VectorXd slopes, double middle, double deviation) {
  const Eigen::Index n = h.z.size();
  const auto total = static_cast<double>(n);
  Eigen::Array<double, 1, kLayers> offset, share;
  const double distance = deviation / std::sqrt(kRoundingVariance * (kLayers * kLayers - 1));
  for (std::size_t c = 0; c < kLayers; ++c) {
    offset[static_cast<Eigen::Index>(c)] = middle + (static_cast<double>(c) - (kLayers - 1) / 2.0) * distance;
  }
  share.setConstant(1.0 / kLayers);
  double sigma = deviation / 2;
  double likelihood = 0;
  Eigen::Array<double, Eigen::Dynamic, kLayers> member(n, kLayers);
  for (int step = 0; step < kSteps; ++step) {
    ArrayXd flat = (h.z - h.terms * slopes).array();
    for (Eigen::Index c = 0; c < member.cols(); ++c) {
      member.col(c) = share[c] * (-0.5 * ((flat - offset[c]) / sigma).square()).exp() + kNoShare;
    }
    const ArrayXd sum = member.rowwise().sum();
    likelihood = sum.log().sum() - total * std::log(sigma);
    member.colwise() /= sum;
    share = member.colwise().sum() / total;
    offset = (member.colwise() * flat).colwise().sum() / (total * share + kNoShare);
    const VectorXd own = (member.rowwise() * offset).rowwise().sum();  // expected offset of a point
    slopes = normal_equations.solve(h.terms.transpose() * (h.z - own));
    flat = (h.z - h.terms * slopes).array();
    // The ball cuts layers near its poles, which makes them look thinner than they are.
    double squares = 0, counted = 0;
    for (Eigen::Index c = 0; c < member.cols(); ++c) {
      if (std::abs(offset[c]) + kTail * sigma > h.most) continue;
      squares += (member.col(c) * (flat - offset[c]).square()).sum();
      counted += total * share[c];
    }
    if (counted <= 0) break;
    const double freedom = 1 - static_cast<double>(kTerms + kLayers) / total;
    sigma = std::max(std::sqrt(squares / (counted * freedom)), kRidge * deviation);  // a mixture must not shrink to points
  }
  return {sigma, -2 * likelihood + 2 * static_cast<double>(kLayers - 1) * std::log(total)};
}

}  // namespace

double layered_deviation(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre,
                         const Vec3& normal) {
  const Heights h = heights(points, index, count, centre, normal);
  const Eigen::Index n = h.z.size();
  if (n <= kTerms + kMostLayers) return 0;
  const auto total = static_cast<double>(n);
  const MatrixXd ridge = kRidge * total * MatrixXd::Identity(kTerms, kTerms);
  // One layer: the constant is the mean of what the other terms leave, so both are taken about their means.
  const Eigen::RowVectorXd mean_term = h.terms.colwise().mean();
  const MatrixXd centred = h.terms.rowwise() - mean_term;
  const Eigen::LDLT<MatrixXd> one(centred.transpose() * centred + ridge);
  const VectorXd slopes = one.solve(centred.transpose() * h.z);
  const double middle = h.z.mean() - mean_term * slopes;
  const double misfit = ((h.z - h.terms * slopes).array() - middle).square().sum();
  if (misfit <= 0) return 0;
  const double deviation = std::sqrt(misfit / (total - kTerms - 1));
  Mixture best{deviation, total * std::log(misfit / total) + total};
  const Eigen::LDLT<MatrixXd> several(h.terms.transpose() * h.terms + ridge);
  for (const Mixture& mixture :
       {fit_mixture<2>(h, several, slopes, middle, deviation), fit_mixture<kMostLayers>(h, several, slopes, middle, deviation)}) {
    if (mixture.criterion < best.criterion) best = mixture;
  }
  return best.sigma;
}

TwoLayers fit_two_layers(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal) {
  constexpr Eigen::Index kMost = kPlaneNeighbours;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kTerms + 2, 0, kMost, kTerms + 2>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Square = Eigen::Matrix<double, kTerms + 2, kTerms + 2>;
  const auto n = static_cast<Eigen::Index>(count);
  const Eigen::Matrix3d frame = tangent_frame(to_eigen(normal));
  const Eigen::Vector3d centre = to_eigen(points[index[0]]);
  const double radius = (to_eigen(points[index[count - 1]]) - centre).norm();
  if (!(radius > 0)) return {};
  Rows rows(n, kTerms + 2);  // on the upper layer, on the lower one, terms
  Column z(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Vector3d q = frame * (to_eigen(points[index[k]]) - centre) / radius;
    rows.row(k) << 0, 0, q[0], q[1], q[0] * q[0], q[0] * q[1], q[1] * q[1];
    z[k] = q[2];
  }
  const Square ridge = kRidge * static_cast<double>(n) * Square::Identity();
  const auto fit = [&]() -> Eigen::Matrix<double, kTerms + 2, 1> {
    return (rows.transpose() * rows + ridge).ldlt().solve(rows.transpose() * z);
  };
  rows.col(0).setOnes();
  Column above = z - rows * fit();  // one layer
  Column sorted = above;
  std::nth_element(sorted.data(), sorted.data() + n / 2, sorted.data() + n);
  double middle = sorted[n / 2];
  TwoLayers layers;
  for (int round = 0; round < kSteps; ++round) {
    bool unchanged = round > 0;
    int upper = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double on_upper = above[k] >= middle ? 1 : 0;
      unchanged = unchanged && rows(k, 0) == on_upper;
      rows(k, 0) = on_upper;
      rows(k, 1) = 1 - on_upper;
      upper += above[k] >= middle ? 1 : 0;
    }
    if (upper < kFewestOnLayer || static_cast<int>(n) - upper < kFewestOnLayer) return {};
    if (unchanged) break;
    const Eigen::Matrix<double, kTerms + 2, 1> solution = fit();
    const double freedom = static_cast<double>(n - kTerms - 2);
    layers = {radius * std::sqrt((z - rows * solution).squaredNorm() / freedom), radius * (solution[0] - solution[1])};
    above = z - rows.rightCols<kTerms>() * solution.tail<kTerms>();
    middle = (solution[0] + solution[1]) / 2;
  }
  return layers;
}

}  // namespace g3r
