#include "cloud/two_layers.h"

#include "cloud/constants.h"
#include "cloud/exact_plane.h"
#include "cloud/quadratic_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

// Heights over a plane through one of the points, in units of the reach of all, and their fits by two offsets and a quadratic.
class TwoLayerFit {
  static constexpr Eigen::Index kUnknowns = kVaryingTerms + 2;
  static constexpr Eigen::Index kMost = kPlaneNeighbours;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kUnknowns, 0, kMost, kUnknowns>;
  using Numbers = Eigen::Vector<double, kUnknowns>;
  using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

 public:
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;

  // `radius`: the reach, above 0.
  TwoLayerFit(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal, double radius)
      : count_(static_cast<Eigen::Index>(count)),
        radius_(radius),
        rows_(count_, kUnknowns),
        heights_(count_),
        ridge_(kRidge * static_cast<double>(count_) * Normal::Identity()) {
    const Eigen::Matrix3d frame = tangent_frame(to_eigen(normal));
    const Eigen::Vector3d centre = to_eigen(points[index[0]]);
    for (Eigen::Index k = 0; k < count_; ++k) {
      const Eigen::Vector3d q = frame * (to_eigen(points[index[k]]) - centre) / radius;
      rows_.row(k) << 0, 0, q[0], q[1], q[0] * q[0], q[0] * q[1], q[1] * q[1];
      heights_[k] = q[2];
    }
  }

  [[nodiscard]] const Column& heights() const { return heights_; }

  // The heights over the quadratic of one layer.
  [[nodiscard]] Column over_one_layer() {
    rows_.leftCols<2>().setZero();
    rows_.col(0).setOnes();
    return heights_ - rows_.lazyProduct(solve());
  }

  // From the points whose `above` is at least `middle`, and those below it, on: fits both, and gives every point to the nearer offset, in
  // turn. Zeros where one of them comes to have so few that a plane goes through them, at any distance from the others.
  [[nodiscard]] TwoLayers from(Column above, double middle) {
    TwoLayers layers;
    for (int round = 0; round < kLayerRounds; ++round) {
      std::size_t upper = 0;
      const bool is_changed = assign(above, middle, upper) || round == 0;
      if (std::min(upper, static_cast<std::size_t>(count_) - upper) <= kPlaneTerms) return {};
      if (!is_changed) break;
      const Numbers solution = solve();
      const double freedom = static_cast<double>(count_ - kUnknowns);
      layers = {radius_ * std::sqrt((heights_ - rows_.lazyProduct(solution)).squaredNorm() / freedom),
                radius_ * (solution[0] - solution[1])};
      above = heights_ - rows_.rightCols<kVaryingTerms>().lazyProduct(solution.tail<kVaryingTerms>());
      middle = (solution[0] + solution[1]) / 2;
    }
    return layers;
  }

 private:
  // Puts every point on the upper or the lower layer, and counts the upper ones. Returns whether any was on the other one.
  bool assign(const Column& above, double middle, std::size_t& upper) {
    bool is_changed = false;
    for (Eigen::Index k = 0; k < count_; ++k) {
      const double on_upper = above[k] >= middle ? 1 : 0;
      is_changed = is_changed || rows_(k, 0) != on_upper;
      rows_(k, 0) = on_upper;
      rows_(k, 1) = 1 - on_upper;
      upper += above[k] >= middle ? 1 : 0;
    }
    return is_changed;
  }

  [[nodiscard]] Numbers solve() const {
    return (Normal(rows_.transpose().lazyProduct(rows_)) + ridge_).ldlt().solve(rows_.transpose().lazyProduct(heights_));
  }

  Eigen::Index count_;
  double radius_;
  Rows rows_;  // on the upper layer, on the lower one, terms
  Column heights_;
  Normal ridge_;
};

}  // namespace

TwoLayers fit_two_layers(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal) {
  const double radius = (to_eigen(points[index[count - 1]]) - to_eigen(points[index[0]])).norm();
  if (!(radius > 0)) return {};
  TwoLayerFit fit(points, index, count, normal, radius);
  const TwoLayers flat = fit.from(fit.heights(), (fit.heights().minCoeff() + fit.heights().maxCoeff()) / 2);
  const TwoLayerFit::Column above = fit.over_one_layer();
  TwoLayerFit::Column sorted = above;
  const auto middle = static_cast<Eigen::Index>(count) / 2;
  std::nth_element(sorted.data(), sorted.data() + middle, sorted.data() + sorted.size());
  const TwoLayers bent = fit.from(above, sorted[middle]);
  return flat.gap > 0 && (bent.gap <= 0 || flat.deviation < bent.deviation) ? flat : bent;
}

}  // namespace g3r
