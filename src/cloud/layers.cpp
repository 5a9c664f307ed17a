#include "cloud/layers.h"

#include "cloud/constants.h"
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

// The radius of the cylinder whose points take part, in distances of the farthest point: a wider one leaves less of its height inside the
// ball of the points, a narrower one has fewer points.
constexpr double kRadius = 0.6;
// Deviations from the middle of a layer up to which it has to be inside that ball for its deviation to count: what is cut looks thinner.
constexpr double kTail = 1.5;
// Layers of a mixture, at most.
constexpr std::size_t kMostLayers = 3;
// What every layer has of a point at least: it keeps the logarithm of a likelihood finite.
constexpr double kNoShare = std::numeric_limits<double>::min();

using Terms = Eigen::Matrix<double, Eigen::Dynamic, kVaryingTerms>;
using Slopes = Eigen::Vector<double, kVaryingTerms>;
using Square = Eigen::Matrix<double, kVaryingTerms, kVaryingTerms>;
using PerLayer = std::array<double, kMostLayers>;

// The heights over a plane through the centre of the n points in the cylinder.
struct Heights {
  Terms terms;      // n x kVaryingTerms, of order 1
  VectorXd z;       // n heights, in the unit of the points
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
  Heights h{Terms(most, kVaryingTerms), VectorXd(most), std::sqrt(1 - kRadius * kRadius) * radius};
  Eigen::Index n = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d q = frame * (to_eigen(points[index[k]]) - to_eigen(centre)) / radius;
    const double u = q[0] / kRadius, v = q[1] / kRadius;
    if (u * u + v * v >= 1) continue;
    h.terms.row(n) << u, v, u * u, u * v, v * v;
    h.z[n++] = q[2] * radius;
  }
  h.terms.conservativeResize(n, kVaryingTerms);
  h.z.conservativeResize(n);
  return h;
}

// A mixture of `layers` Gaussians and a quadratic, by expectation and maximisation.
class MixtureFit {
 public:
  // Starts from one layer's fit, with equal layers at equal distances that without scatter have its deviation.
  MixtureFit(const Heights& h, std::size_t layers, const Eigen::LDLT<Square>& normal_equations, const Start& start)
      : h_(h),
        layers_(layers),
        normal_equations_(normal_equations),
        one_deviation_(start.deviation),
        sigma_(start.deviation / 2),
        member_(static_cast<std::size_t>(h.z.size())),
        flat_(h.z - h.terms.lazyProduct(start.slopes)) {
    const auto count = static_cast<double>(layers);
    const double distance = start.deviation / std::sqrt(kRoundingVariance * (count * count - 1));
    for (std::size_t c = 0; c < layers; ++c) {
      offset_[c] = start.middle + (static_cast<double>(c) - (count - 1) / 2) * distance;
      share_[c] = 1 / count;
    }
  }

  Mixture run() {
    for (int step = 0; step < kLayerRounds; ++step) {
      const PerLayer mass = expect();
      fit_quadratic();
      if (!fit_deviation(mass)) break;
    }
    return {sigma_, -2 * likelihood_ + 2 * (static_cast<double>(layers_) - 1) * std::log(total())};
  }

 private:
  [[nodiscard]] double total() const { return static_cast<double>(member_.size()); }
  [[nodiscard]] double flat(std::size_t k) const { return flat_[static_cast<Eigen::Index>(k)]; }

  // The chances of every point to be on each layer, and the shares and offsets of the layers that follow from them. Returns the points that
  // each layer has.
  PerLayer expect() {
    likelihood_ = -total() * std::log(sigma_);
    PerLayer mass{}, moment{};
    for (std::size_t k = 0; k < member_.size(); ++k) {
      const double z = flat(k);
      double sum = 0;
      for (std::size_t c = 0; c < layers_; ++c) sum += member_[k][c] = share_[c] * gaussian((z - offset_[c]) / sigma_) + kNoShare;
      likelihood_ += std::log(sum);
      for (std::size_t c = 0; c < layers_; ++c) {
        member_[k][c] /= sum;
        mass[c] += member_[k][c];
        moment[c] += member_[k][c] * z;
      }
    }
    for (std::size_t c = 0; c < layers_; ++c) {
      share_[c] = mass[c] / total();
      offset_[c] = moment[c] / (mass[c] + kNoShare);
    }
    return mass;
  }

  // The quadratic through the heights without their expected offsets.
  void fit_quadratic() {
    VectorXd rest = h_.z;
    for (std::size_t k = 0; k < member_.size(); ++k) {
      for (std::size_t c = 0; c < layers_; ++c) rest[static_cast<Eigen::Index>(k)] -= member_[k][c] * offset_[c];
    }
    flat_ = h_.z - h_.terms.lazyProduct(normal_equations_.solve(h_.terms.transpose().lazyProduct(rest)));
  }

  // The deviation of the layers that the ball does not cut, as it does near its poles, where they look thinner than they are. False if it
  // cuts all.
  bool fit_deviation(const PerLayer& mass) {
    double squares = 0, counted = 0;
    for (std::size_t c = 0; c < layers_; ++c) {
      if (std::abs(offset_[c]) + kTail * sigma_ > h_.most) continue;
      for (std::size_t k = 0; k < member_.size(); ++k) squares += member_[k][c] * std::pow(flat(k) - offset_[c], 2);
      counted += mass[c];
    }
    if (counted <= 0) return false;
    const double freedom = 1 - (static_cast<double>(kVaryingTerms) + static_cast<double>(layers_)) / total();
    sigma_ = std::max(std::sqrt(squares / (counted * freedom)), kRidge * one_deviation_);  // a mixture must not shrink to points
    return true;
  }

  const Heights& h_;
  std::size_t layers_;
  const Eigen::LDLT<Square>& normal_equations_;
  double one_deviation_;  // about one layer
  double sigma_;
  double likelihood_ = 0;  // its logarithm, but for a constant
  PerLayer offset_{}, share_{};
  std::vector<PerLayer> member_;  // the chance that a point is on a layer
  VectorXd flat_;                 // heights without the quadratic
};

}  // namespace

double layered_deviation(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& centre,
                         const Vec3& normal) {
  const Heights h = heights(points, index, count, centre, normal);
  const Eigen::Index n = h.z.size();
  if (n <= kVaryingTerms + static_cast<Eigen::Index>(kMostLayers)) return 0;
  const auto total = static_cast<double>(n);
  const Square ridge = kRidge * total * Square::Identity();
  // One layer: the constant is the mean of what the other terms leave, so both are taken about their means.
  const Eigen::RowVector<double, kVaryingTerms> mean_term = h.terms.colwise().mean();
  const Terms centred = h.terms.rowwise() - mean_term;
  const Eigen::LDLT<Square> one(Square(centred.transpose().lazyProduct(centred)) + ridge);
  const Slopes slopes = one.solve(centred.transpose().lazyProduct(h.z));
  const double middle = h.z.mean() - mean_term * slopes;
  const double misfit = ((h.z - h.terms.lazyProduct(slopes)).array() - middle).square().sum();
  if (misfit <= 0) return 0;
  const double deviation = std::sqrt(misfit / (total - kVaryingTerms - 1));
  Mixture best{deviation, total * std::log(misfit / total) + total};
  const Eigen::LDLT<Square> several(Square(h.terms.transpose().lazyProduct(h.terms)) + ridge);
  for (std::size_t layers = 2; layers <= kMostLayers; ++layers) {
    const Mixture mixture = MixtureFit(h, layers, several, {slopes, middle, deviation}).run();
    if (mixture.criterion < best.criterion) best = mixture;
  }
  return best.sigma;
}

}  // namespace g3r
