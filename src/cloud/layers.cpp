#include "cloud/layers.h"

#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/noise.h"
#include "cloud/quadratic_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace g3r {
namespace {

using Eigen::VectorXd;

constexpr double kRadius = 0.6;                       // of the cylinder, in distances of the farthest point
constexpr double kTail = 1.5;                         // deviations of a layer that have to be inside for its own deviation to count
constexpr Eigen::Index kTerms = kQuadraticTerms - 1;  // u, v, u^2, u v, v^2
constexpr int kSteps = 20;  // of expectation and maximisation, and of points that look for their layer: most change theirs 4 times
constexpr std::size_t kMostLayers = 3;
constexpr double kNoShare = std::numeric_limits<double>::min();  // keeps the logarithm of a likelihood finite

using Terms = Eigen::Matrix<double, Eigen::Dynamic, kTerms>;
using Slopes = Eigen::Vector<double, kTerms>;
using Square = Eigen::Matrix<double, kTerms, kTerms>;
using PerLayer = std::array<double, kMostLayers>;

struct Heights {
  Terms terms;      // n x kTerms, of order 1
  VectorXd z;       // from the centre
  double most = 0;  // |z| up to which the cylinder is inside the ball of the points
};

// The fit of one layer.
struct Start {
  Slopes slopes;
  double middle = 0;  // its constant
  double deviation = 0;
};

struct Mixture {
  double sigma = 0;
  double criterion = 0;  // Bayesian information criterion, but for a constant
};

double gaussian(double x) { return std::exp(-0.5 * x * x); }

Heights heights(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre, const Vec3& normal) {
  const Eigen::Matrix3d frame = tangent_frame(to_eigen(normal));
  const double radius = (to_eigen(points[index[count - 1]]) - to_eigen(centre)).norm();
  const auto most = static_cast<Eigen::Index>(count);
  Heights h{Terms(most, kTerms), VectorXd(most), std::sqrt(1 - kRadius * kRadius) * radius};
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

// A mixture of so many layers, from one layer's fit (`slopes`, `middle`, `deviation`) on, where equal layers at equal distances, without
// scatter, have its deviation.
Mixture fit_mixture(const Heights& h, std::size_t layers, const Eigen::LDLT<Square>& normal_equations, const Start& start) {
  const auto count = static_cast<std::size_t>(h.z.size());
  const auto total = static_cast<double>(count);
  const auto of_layers = static_cast<double>(layers);
  PerLayer offset{}, share{};
  const double distance = start.deviation / std::sqrt(kRoundingVariance * (of_layers * of_layers - 1));
  for (std::size_t c = 0; c < layers; ++c) {
    offset[c] = start.middle + (static_cast<double>(c) - (of_layers - 1) / 2) * distance;
    share[c] = 1 / of_layers;
  }
  double sigma = start.deviation / 2;
  double likelihood = 0;
  std::vector<PerLayer> member(count);  // the chance that a point is on a layer
  VectorXd flat = h.z - h.terms.lazyProduct(start.slopes);
  VectorXd rest(h.z.size());  // without the expected offset
  for (int step = 0; step < kSteps; ++step) {
    likelihood = -total * std::log(sigma);
    PerLayer mass{}, moment{};
    for (std::size_t k = 0; k < count; ++k) {
      const double z = flat[static_cast<Eigen::Index>(k)];
      double sum = 0;
      for (std::size_t c = 0; c < layers; ++c) sum += member[k][c] = share[c] * gaussian((z - offset[c]) / sigma) + kNoShare;
      likelihood += std::log(sum);
      for (std::size_t c = 0; c < layers; ++c) {
        member[k][c] /= sum;
        mass[c] += member[k][c];
        moment[c] += member[k][c] * z;
      }
    }
    for (std::size_t c = 0; c < layers; ++c) {
      share[c] = mass[c] / total;
      offset[c] = moment[c] / (mass[c] + kNoShare);
    }
    rest = h.z;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t c = 0; c < layers; ++c) rest[static_cast<Eigen::Index>(k)] -= member[k][c] * offset[c];
    }
    flat = h.z - h.terms.lazyProduct(normal_equations.solve(h.terms.transpose().lazyProduct(rest)));
    // The ball cuts layers near its poles, which makes them look thinner than they are.
    double squares = 0, counted = 0;
    for (std::size_t c = 0; c < layers; ++c) {
      if (std::abs(offset[c]) + kTail * sigma > h.most) continue;
      for (std::size_t k = 0; k < count; ++k) squares += member[k][c] * std::pow(flat[static_cast<Eigen::Index>(k)] - offset[c], 2);
      counted += mass[c];
    }
    if (counted <= 0) break;
    const double freedom = 1 - (static_cast<double>(kTerms) + of_layers) / total;
    sigma = std::max(std::sqrt(squares / (counted * freedom)), kRidge * start.deviation);  // a mixture must not shrink to points
  }
  return {sigma, -2 * likelihood + 2 * (of_layers - 1) * std::log(total)};
}

}  // namespace

double layered_deviation(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre,
                         const Vec3& normal) {
  const Heights h = heights(points, index, count, centre, normal);
  const Eigen::Index n = h.z.size();
  if (n <= kTerms + static_cast<Eigen::Index>(kMostLayers)) return 0;
  const auto total = static_cast<double>(n);
  const Square ridge = kRidge * total * Square::Identity();
  // One layer: the constant is the mean of what the other terms leave, so both are taken about their means.
  const Eigen::RowVector<double, kTerms> mean_term = h.terms.colwise().mean();
  const Terms centred = h.terms.rowwise() - mean_term;
  const Eigen::LDLT<Square> one(Square(centred.transpose().lazyProduct(centred)) + ridge);
  const Slopes slopes = one.solve(centred.transpose().lazyProduct(h.z));
  const double middle = h.z.mean() - mean_term * slopes;
  const double misfit = ((h.z - h.terms.lazyProduct(slopes)).array() - middle).square().sum();
  if (misfit <= 0) return 0;
  const double deviation = std::sqrt(misfit / (total - kTerms - 1));
  Mixture best{deviation, total * std::log(misfit / total) + total};
  const Eigen::LDLT<Square> several(Square(h.terms.transpose().lazyProduct(h.terms)) + ridge);
  for (std::size_t layers = 2; layers <= kMostLayers; ++layers) {
    const Mixture mixture = fit_mixture(h, layers, several, {slopes, middle, deviation});
    if (mixture.criterion < best.criterion) best = mixture;
  }
  return best.sigma;
}

TwoLayers fit_two_layers(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal) {
  constexpr Eigen::Index kMost = kPlaneNeighbours;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kTerms + 2, 0, kMost, kTerms + 2>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Numbers = Eigen::Vector<double, kTerms + 2>;
  using Normal = Eigen::Matrix<double, kTerms + 2, kTerms + 2>;
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
  const Normal ridge = kRidge * static_cast<double>(n) * Normal::Identity();
  const auto fit = [&]() -> Numbers {
    return (Normal(rows.transpose().lazyProduct(rows)) + ridge).ldlt().solve(rows.transpose().lazyProduct(z));
  };
  // From the points above and below a middle, at these heights, on.
  const auto from = [&](Column above, double middle) -> TwoLayers {
    TwoLayers layers;
    for (int round = 0; round < kSteps; ++round) {
      bool unchanged = round > 0;
      std::size_t upper = 0;
      for (Eigen::Index k = 0; k < n; ++k) {
        const double on_upper = above[k] >= middle ? 1 : 0;
        unchanged = unchanged && rows(k, 0) == on_upper;
        rows(k, 0) = on_upper;
        rows(k, 1) = 1 - on_upper;
        upper += above[k] >= middle ? 1 : 0;
      }
      if (std::min(upper, count - upper) <= kPlaneTerms) return {};  // a plane goes through so few, at any distance from the others
      if (unchanged) break;
      const Numbers solution = fit();
      const double freedom = static_cast<double>(n - kTerms - 2);
      layers = {radius * std::sqrt((z - rows.lazyProduct(solution)).squaredNorm() / freedom), radius * (solution[0] - solution[1])};
      above = z - rows.rightCols<kTerms>().lazyProduct(solution.tail<kTerms>());
      middle = (solution[0] + solution[1]) / 2;
    }
    return layers;
  };
  const TwoLayers flat = from(z, (z.minCoeff() + z.maxCoeff()) / 2);
  rows.leftCols<2>().setZero();
  rows.col(0).setOnes();
  const Column above = z - rows.lazyProduct(fit());  // one layer
  Column sorted = above;
  std::nth_element(sorted.data(), sorted.data() + n / 2, sorted.data() + n);
  const TwoLayers bent = from(above, sorted[n / 2]);
  return flat.gap > 0 && (bent.gap <= 0 || flat.deviation < bent.deviation) ? flat : bent;
}

}  // namespace g3r
