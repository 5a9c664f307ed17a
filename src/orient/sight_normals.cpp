#include "orient/sight_normals.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/neighbours.h"
#include "cloud/some_places.h"
#include "cpu/parallel.h"
#include "orient/confidence.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace g3r {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Rounds of weights, which go from those of all points around to those of the points of one surface.
constexpr int kSightRounds = 4;
// Points, as they are seen next to each other, that noise is looked for in, each scale four times as many.
constexpr std::array<std::size_t, kScales> kAlong{kTwoPatches, (kTwiceAsFar * kTwoPatches), (kTwiceAsFar * kTwiceAsFar * kTwoPatches)};

// The points that one sensor has seen, and fits of planes to them.
class Seen {
 public:
  Seen(const std::vector<Vec3>& points, std::vector<std::uint32_t> members, const Vec3& place, double noise)
      : members_(std::move(members)), noise_(noise) {
    for (const std::uint32_t i : members_) {
      const Vec3 d = vector::subtract(points[i], place);
      distance_.push_back(std::sqrt(vector::dot(d, d)));
      sight_.push_back(vector::normalised(d));
    }
  }

  [[nodiscard]] const std::vector<Vec3>& sights() const { return sight_; }

  // Normals of members [begin, end), and how certain their sides are, by every `step`-th member, of which `together` have one error;
  // `tree`: of their sights. Where errors are each point's own, the fits that follow (noisy_jets.h) are as wide as the surface allows.
  void fit(const Neighbours& tree, std::size_t step, double together, std::size_t begin, std::size_t end, SightNormals& out) const {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t k = begin; k < end; ++k) {
      tree.nearest(sight_[k], together > 1 ? kAlong.back() : kTwoPatches, index, squared);
      for (std::uint32_t& i : index) i *= static_cast<std::uint32_t>(step);
      if (k % step != 0) {  // the point is not in the tree
        index.insert(index.begin(), static_cast<std::uint32_t>(k));
        squared.insert(squared.begin(), 0);
      }
      const Plane plane = widest(index, squared, together);
      const double size = plane.m.norm();
      if (!(size > 0)) continue;
      const Vector3d normal = -plane.m / size;
      const double cosine = -normal.dot(to_vector(sight_[k]));
      out.normals[members_[k]] = {normal[0], normal[1], normal[2]};
      // The direction turns by what m is off across itself, as a share of its length.
      const double deviation = std::sqrt(std::max(0.0, (plane.covariance.trace() - normal.dot(plane.covariance * normal)) / 2)) / size;
      const double steps = deviation > 0 ? std::asin(std::clamp(cosine, -1.0, 1.0)) / deviation : HUGE_VAL;
      out.certified[members_[k]] = static_cast<float>(normal_distribution(std::max(0.0, steps)));
    }
  }

  // Root mean square residual, as depth, of the quadratic in the angle that the `count` points nearest to one are fitted by.
  [[nodiscard]] double residual(const Neighbours& tree, std::size_t k, std::size_t count) const {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    tree.nearest(sight_[k], count, index, squared);
    const Vector3d axis = to_vector(sight_[k]);
    const Vector3d across = axis.unitOrthogonal();
    const Vector3d along = axis.cross(across);
    const double reach = std::sqrt(squared.back());
    using Terms = Eigen::Matrix<double, kQuadraticTerms, 1>;
    Eigen::Matrix<double, kQuadraticTerms, kQuadraticTerms> matrix = Eigen::Matrix<double, kQuadraticTerms, kQuadraticTerms>::Zero();
    Terms right = Terms::Zero();
    double square = 0;
    for (const std::uint32_t j : index) {
      const double x = across.dot(to_vector(sight_[j])) / reach;
      const double y = along.dot(to_vector(sight_[j])) / reach;
      const Terms terms{1, x, y, x * x, x * y, y * y};
      const double depth = distance_[k] * (distance_[k] / distance_[j] - 1);
      matrix += terms * terms.transpose();
      right += depth * terms;
      square += depth * depth;
    }
    matrix.diagonal().array() += kRidge * matrix.trace();
    const double left = square - right.dot(matrix.ldlt().solve(right));
    return std::sqrt(std::max(0.0, left) / static_cast<double>(count - kQuadraticTerms));
  }

 private:
  struct Plane {
    Vector3d m = Vector3d::Zero();
    Matrix3d covariance = Matrix3d::Zero();
  };

  // The plane of as many of the points, nearest first, from 24 on and twice as many each time, as agree on its normal: while it stays
  // within what the noise turns those of fewer by (Lepski; noisy_jets.h).
  [[nodiscard]] Plane widest(const std::vector<std::uint32_t>& index, const std::vector<double>& squared, double together) const {
    std::vector<std::pair<Vector3d, double>> narrower;
    Plane best;
    for (std::size_t count = std::min(kTwoPatches, index.size());; count = std::min(2 * count, index.size())) {
      const Plane plane = fit_plane(index, squared, count);
      const Vector3d normal = plane.m.normalized();
      const bool agrees =
          std::all_of(narrower.begin(), narrower.end(), [&](const auto& n) { return (normal - n.first).norm() <= n.second; });
      if (!agrees) break;
      best = plane;
      if (count == index.size()) break;
      const double reach = distance_[index.front()] * std::sqrt(squared[count - 1]);
      const double independent = static_cast<double>(count) / together;
      narrower.emplace_back(normal, kWider * noise_ * std::sqrt(6 / independent) / reach);
    }
    best.covariance *= together;
    return best;
  }

  static Vector3d to_vector(const Vec3& v) { return {v[0], v[1], v[2]}; }

  // m of the first `count` members of `index`, whose squared distances between sights are given, the first is its own. An error e in rho is
  // one of e / rho^2 in 1 / rho.
  [[nodiscard]] Plane fit_plane(const std::vector<std::uint32_t>& index, const std::vector<double>& squared, std::size_t count) const {
    const double reach = squared[count - 1] * (1 + 1 / static_cast<double>(count));
    std::vector<double> likely(count, 1);
    Plane plane;
    for (int round = 0; round < kSightRounds; ++round) {
      Matrix3d normal_matrix = Matrix3d::Zero();
      Vector3d right = Vector3d::Zero();
      double total = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double rho = distance_[index[k]];
        const double weight = (1 - squared[k] / reach) * likely[k];
        const Vector3d d = to_vector(sight_[index[k]]) * (rho * rho);
        normal_matrix += weight * d * d.transpose();
        right += weight * rho * d;
        total += weight;
      }
      normal_matrix.diagonal().array() += kRidge * normal_matrix.trace();
      const Eigen::LDLT<Matrix3d> solver(normal_matrix);
      plane.m = solver.solve(right);
      double residuals = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double rho = distance_[index[k]];
        const double along = rho * (rho * plane.m.dot(to_vector(sight_[index[k]])) - 1);
        residuals += (1 - squared[k] / reach) * likely[k] * along * along;
        const double share = std::min(1.0, std::abs(along) / (kNoiseBreadth * noise_));
        likely[k] = (1 - share * share) * (1 - share * share);
      }
      likely.front() = 1;  // it is of its own surface
      const double variance = total > kPlaneTerms ? residuals / (total - kPlaneTerms) : HUGE_VAL;
      plane.covariance = variance * solver.solve(Matrix3d::Identity());
    }
    return plane;
  }

  std::vector<std::uint32_t> members_;
  double noise_;
  std::vector<double> distance_;
  std::vector<Vec3> sight_;
};

// The points of every sensor, as indices.
std::vector<std::vector<std::uint32_t>> members_of(const PointSet& set) {
  const Views& views = set.views();
  std::vector<std::vector<std::uint32_t>> members(views.is_one() ? 1 : views.places.size());
  for (std::uint32_t i = 0; i < set.size(); ++i) members[views.is_one() ? 0 : views.of_point[i]].push_back(i);
  return members;
}

}  // namespace

SightNoise find_sight_noise(const PointSet& set, const std::atomic<bool>* cancel) {
  std::vector<std::vector<std::uint32_t>> members = members_of(set);
  const std::size_t wanted = 1 + kFewPlaces / members.size();
  std::array<std::vector<double>, kScales> residuals;
  for (std::size_t v = 0; v < members.size(); ++v) {
    const std::size_t count = members[v].size();
    if (count < kSmallPart * kTwoPatches) continue;
    const Seen seen(set.points(), std::move(members[v]), set.views().places[v], 0);
    const Neighbours tree(seen.sights());
    const SomePlaces some = SomePlaces::at_least(wanted, count);
    for (std::size_t scale = 0; scale < kScales && kSmallPart * kAlong[scale] <= count; ++scale) {
      std::vector<double> found(some.size());
      parallel::for_each(
          some.size(), [&](std::size_t k) { found[k] = seen.residual(tree, some[k], kAlong[scale]); }, cancel);
      residuals[scale].insert(residuals[scale].end(), found.begin(), found.end());
    }
  }
  for (std::size_t scale = 0; scale + 1 < kScales && !residuals[scale + 1].empty(); ++scale) {
    const double near = median(residuals[scale]);
    const double far = median(residuals[scale + 1]);
    if (far < kWider * near) return scale == 0 ? SightNoise{near} : SightNoise{far, kAlong[scale]};
  }
  return {};
}

SightNormals normals_by_sight(const PointSet& set, const SightNoise& noise, const std::atomic<bool>* cancel) {
  const Views& views = set.views();
  std::vector<std::vector<std::uint32_t>> members = members_of(set);
  // Where errors are of many points, fewer say as much.
  const std::size_t step = std::max<std::size_t>(1, noise.together / kTwoPatches);
  const double together = static_cast<double>(noise.together) / static_cast<double>(step);
  SightNormals out{std::vector<Vec3>(set.size(), Vec3{0, 0, 0}), std::vector<float>(set.size(), kUndecided)};
  for (std::size_t v = 0; v < members.size(); ++v) {
    if (members[v].empty()) continue;
    const std::size_t count = members[v].size();
    const Seen seen(set.points(), std::move(members[v]), views.places[v], noise.deviation);
    std::vector<Vec3> sights;
    for (std::size_t k = 0; k < count; k += step) sights.push_back(seen.sights()[k]);
    const Neighbours tree(sights);
    const auto fit = [&](std::size_t begin, std::size_t end) { seen.fit(tree, step, together, begin, end, out); };
    parallel::for_blocks(count, parallel::kSmallBlock, fit, cancel);
  }
  for (std::uint32_t i = 0; i < set.size(); ++i) {
    if (vector::dot(out.normals[i], out.normals[i]) > 0) continue;
    out.normals[i] = vector::normalised(vector::subtract(views.place_of(i), set.points()[i]));
  }
  return out;
}

}  // namespace g3r
