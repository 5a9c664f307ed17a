// The points around a noisy one that lie on its side of the surface, for local fits.
#pragma once

#include "cloud/neighbours.h"
#include "cloud/quadratic_patch.h"

#include <g3r/points.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Gathers the members of one fit after the other. Points whose normals are within 60 degrees of the axis are on its side: so a fit has the
/// points of its own wall, however thin that is. It refers to all three vectors; they may change between fits.
class SameSide {
 public:
  SameSide(const std::vector<Vec3>& points, const Neighbours& tree, const std::vector<Vec3>& normals)
      : points_(points), tree_(tree), normals_(normals) {}

  /// The points around point i that are less than `reach` from it across `axis` (unit length), with the weights 1 - r^2 / reach^2
  /// (Epanechnikov), r the distance across, and less than sqrt(reach^2 + depth^2) in all. Of more than 2000 as many evenly picked ones.
  /// Returns the share of the weight that faces away from `axis`, 0 if there is none. O(their number).
  double gather(std::size_t i, const Eigen::Vector3d& axis, double reach, double depth);

  [[nodiscard]] const std::vector<FitPoint>& members() const { return members_; }   ///< relative to point i
  [[nodiscard]] const std::vector<std::uint32_t>& indices() const { return own_; }  ///< of the members
  [[nodiscard]] double weight() const { return weight_; }                           ///< of all members
  [[nodiscard]] std::size_t seen() const { return index_.size(); }                  ///< points in the ball, members or not

 private:
  const std::vector<Vec3>& points_;
  const Neighbours& tree_;
  const std::vector<Vec3>& normals_;
  std::vector<std::uint32_t> index_;
  std::vector<FitPoint> members_;
  std::vector<std::uint32_t> own_;
  double weight_ = 0;
};

}  // namespace g3r
