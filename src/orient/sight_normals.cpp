#include "orient/sight_normals.h"

#include "base/vector.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "orient/confidence.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
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

  // Normals of members [begin, end), and how certain their sides are.
  void fit(const Neighbours& tree, std::size_t begin, std::size_t end, SightNormals& out) const {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t k = begin; k < end; ++k) {
      tree.nearest(sight_[k], kTwoPatches, index, squared);
      const Plane plane = fit_plane(index, squared);
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

 private:
  struct Plane {
    Vector3d m = Vector3d::Zero();
    Matrix3d covariance = Matrix3d::Zero();
  };

  static Vector3d to_vector(const Vec3& v) { return {v[0], v[1], v[2]}; }

  // m of the members `index`, whose squared distances between sights are given, the first is its own. An error e in rho is one of e / rho^2
  // in 1 / rho.
  [[nodiscard]] Plane fit_plane(const std::vector<std::uint32_t>& index, const std::vector<double>& squared) const {
    const double reach = squared.back() * (1 + 1 / static_cast<double>(index.size()));
    std::vector<double> likely(index.size(), 1);
    Plane plane;
    for (int round = 0; round < kSightRounds; ++round) {
      Matrix3d normal_matrix = Matrix3d::Zero();
      Vector3d right = Vector3d::Zero();
      double total = 0;
      for (std::size_t k = 0; k < index.size(); ++k) {
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
      for (std::size_t k = 0; k < index.size(); ++k) {
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

}  // namespace

SightNormals normals_by_sight(const PointSet& set, double noise, const std::atomic<bool>* cancel) {
  const Views& views = set.views();
  std::vector<std::vector<std::uint32_t>> members(views.is_one() ? 1 : views.places.size());
  for (std::uint32_t i = 0; i < set.size(); ++i) members[views.is_one() ? 0 : views.of_point[i]].push_back(i);
  SightNormals out{std::vector<Vec3>(set.size(), Vec3{0, 0, 0}), std::vector<float>(set.size(), kUndecided)};
  for (std::size_t v = 0; v < members.size(); ++v) {
    if (members[v].empty()) continue;
    const std::size_t count = members[v].size();
    const Seen seen(set.points(), std::move(members[v]), views.places[v], noise);
    const Neighbours tree(seen.sights());
    parallel::for_blocks(
        count, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) { seen.fit(tree, begin, end, out); }, cancel);
  }
  for (std::uint32_t i = 0; i < set.size(); ++i) {
    if (vector::dot(out.normals[i], out.normals[i]) > 0) continue;
    out.normals[i] = vector::normalised(vector::subtract(views.place_of(i), set.points()[i]));
  }
  return out;
}

}  // namespace g3r
