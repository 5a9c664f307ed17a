#include "orient/noisy_jets.h"

#include "base/median.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/quadratic_patch.h"
#include "cloud/spacing.h"
#include "cpu/parallel.h"
#include "orient/same_side.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace g3r {
namespace {

using Eigen::Vector3d;

// The share of its reach up to which a fit serves the points around its middle, and at which slopes weigh as much as heights: the normals
// of those points are those of a smooth field already. Less leaves noise, more blurs.
constexpr double kShared = 0.25;

struct Fit {
  QuadraticPatch patch;  // relative to the point it was fitted at
  double reach = 0;      // 0: none
};

// Fits at one point after the other.
class Fitter {
 public:
  Fitter(const std::vector<Vec3>& points, const Neighbours& neighbours, const std::vector<Vec3>& normals, double noise, double spacing)
      : points_(points), normals_(normals), noise_(noise), spacing_(spacing), side_(points, neighbours, normals) {}

  [[nodiscard]] double noise() const { return noise_; }
  // The first of the reaches that is no less than the spacing, as within less there are too few points for a fit; 0 without noise.
  [[nodiscard]] double first_reach() const {
    double reach = kWider * kNoiseReach * std::sqrt(noise_ * spacing_);
    while (reach > 0 && reach < spacing_) reach *= kWider;
    return reach;
  }

  // From now on, fits with the noise of points [begin, end) where it is less than the cloud's: what is more may be detail. One of as many
  // points as are near one tells.
  void follow_noise(std::size_t begin, std::size_t end) {
    scatter_.clear();
    for (std::size_t i = begin; i < end; i += kSpacingNeighbours) {
      const double reach = kNoiseReach * spacing_;
      if (!gather(i, to_eigen(normals_[i]), reach) || side_.members().empty()) continue;
      const double found = residual(fit_quadratic_patch(side_.members(), 0, reach / 2, 0), side_.members());
      if (std::isfinite(found)) scatter_.push_back(found);
    }
    if (scatter_.empty()) return;
    noise_ = std::min(median(scatter_), noise_);
  }

  // The widest fit at point i whose normal agrees with those of the narrower ones; none where there is no noise.
  Fit widest(std::size_t i) {
    const Vector3d normal = to_eigen(normals_[i]);
    Vector3d axis = normal;
    Fit best;
    narrower_.clear();
    bool is_widest = false;
    const double arm = 2 * kShared;  // in halves of the reach, the unit of the fit
    for (double reach = first_reach(); reach > 0 && !is_widest; reach *= kWider) {
      if (!gather(i, axis, reach)) break;
      is_widest = side_.seen() >= std::min(kPlaces, points_.size());
      const std::size_t count = side_.members().size();
      if (count <= kQuadraticTerms) continue;
      const QuadraticPatch patch = fit_quadratic_patch(side_.members(), 0, reach / 2, arm * arm);
      Vector3d fitted;
      (void)patch.distance(Vector3d::Zero(), &fitted);
      if (fitted.dot(normal) <= kSameSide) continue;
      const bool agrees =
          std::all_of(narrower_.begin(), narrower_.end(), [&](const Estimate& e) { return (e.normal - fitted).norm() <= e.deviation; });
      if (!agrees) break;
      const double freedom = static_cast<double>(count - kQuadraticTerms) / static_cast<double>(count);
      narrower_.push_back({fitted, noise_ * std::sqrt(6 / (side_.weight() * freedom)) / reach});
      best = {patch, reach};
      axis = fitted;
    }
    return best;
  }

 private:
  struct Estimate {
    Vector3d normal;
    double deviation = 0;
  };

  // False where more of the points around point i face the other way than do by chance: another wall is too close.
  bool gather(std::size_t i, const Vector3d& axis, double reach) { return side_.gather(i, axis, reach, kSigmas * noise_) <= kFalseAlarms; }

  const std::vector<Vec3>& points_;
  const std::vector<Vec3>& normals_;
  double noise_;
  const double spacing_;
  SameSide side_;
  std::vector<Estimate> narrower_;
  std::vector<double> scatter_;
};

}  // namespace

void fit_noisy_jets(const PointSet& set, double noise, const std::vector<std::uint8_t>& wanted, std::vector<Vec3>& normals,
                    const std::atomic<bool>* cancel) {
  const std::vector<Vec3>& points = set.points();
  const double spacing = set.spacing();
  const Neighbours& tree = set.tree();
  std::vector<Vec3> out = normals;
  const auto is_wanted = [&](std::size_t i) { return wanted.empty() || wanted[i] != 0; };
  const auto fit_block = [&](std::size_t begin, std::size_t end) {
    std::size_t first = begin;
    while (first < end && !is_wanted(first)) ++first;
    if (first == end) return;
    Fitter fitter(points, tree, normals, noise, spacing);
    fitter.follow_noise(begin, end);
    const double depth = kSigmas * fitter.noise();
    std::vector<std::uint8_t> done(end - begin, 0);
    for (std::size_t i = first; i < end; ++i) {
      if (done[i - begin] != 0 || !is_wanted(i)) continue;
      const Fit fit = fitter.widest(i);
      const Vector3d centre = to_eigen(points[i]);
      if (fit.reach == 0) continue;
      const double shared = kShared * fit.reach;
      for (std::size_t j = i; j < end; ++j) {
        const Vector3d d = to_eigen(points[j]) - centre;
        if (done[j - begin] != 0 || !is_wanted(j) || d.squaredNorm() > shared * shared + depth * depth) continue;
        const Vector3d n = to_eigen(normals[j]);
        Vector3d above;
        const double beside = std::abs(fit.patch.distance(d, &above));
        const bool served = beside <= depth && d.squaredNorm() - beside * beside <= shared * shared && n.dot(above) > kSameSide;
        if (j != i && !served) continue;
        out[j] = {above[0], above[1], above[2]};
        done[j - begin] = 1;
      }
    }
  };
  parallel::for_blocks(points.size(), parallel::kSmallBlock, fit_block, cancel);
  normals = std::move(out);
}

}  // namespace g3r
