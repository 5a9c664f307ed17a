#include "orient/same_side.h"

#include "cloud/constants.h"
#include "cloud/some_places.h"

#include <cmath>

namespace g3r {

double SameSide::gather(std::size_t i, const Eigen::Vector3d& axis, double reach, double depth) {
  const Eigen::Vector3d centre = to_eigen(points_[i]);
  tree_.within(points_[i], std::hypot(reach, depth), index_);
  const SomePlaces some = SomePlaces::at_most(kPlaces, index_.size());
  members_.clear();
  own_.clear();
  weight_ = 0;
  double opposed = 0;
  for (std::size_t k = 0; k < some.size(); ++k) {
    const std::uint32_t j = index_[some[k]];
    const Eigen::Vector3d d = to_eigen(points_[j]) - centre;
    const double height = axis.dot(d);
    const double weight = 1 - (d.squaredNorm() - height * height) / (reach * reach);
    if (weight <= 0) continue;
    const Eigen::Vector3d n = to_eigen(normals_[j]);
    const double cosine = n.dot(axis);
    if (cosine > kSameSide) {
      members_.push_back({d, n, weight, 0});
      own_.push_back(j);
      weight_ += weight;
    } else if (cosine <= 0) {
      opposed += weight;
    }
  }
  return opposed > 0 ? opposed / (opposed + weight_) : 0;
}

}  // namespace g3r
