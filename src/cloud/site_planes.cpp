#include "cloud/site_planes.h"

#include "base/vector.h"
#include "cloud/constants.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

// The plane of a site is fitted to the points within so many distances of sites, about 20 sites: its neighbours and theirs.
constexpr double kReach = 2.5;

// The plane through n points around `centre`, weights 1 - r^2 / R^2, with R the radius that one more would be at: that of the farthest
// times sqrt(1 + 1 / n).
SitePlane fit_plane_at(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& index, const Vec3& centre) {
  using Eigen::Vector3d;
  const auto from_centre = [&](std::uint32_t j) {
    const Vec3 d = vector::subtract(points[j], centre);
    return Vector3d(d[0], d[1], d[2]);
  };
  double reach = 0;
  for (const std::uint32_t j : index) reach = std::max(reach, from_centre(j).squaredNorm());
  reach *= 1 + 1 / static_cast<double>(index.size());
  Vector3d mean = Vector3d::Zero();
  double total = 0;
  for (const std::uint32_t j : index) {
    const double weight = 1 - from_centre(j).squaredNorm() / reach;
    mean += weight * from_centre(j);
    total += weight;
  }
  mean /= total;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::uint32_t j : index) {
    const Vector3d d = from_centre(j) - mean;
    spread += (1 - from_centre(j).squaredNorm() / reach) * d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(spread / reach);
  const Vector3d normal = eigen.eigenvectors().col(0);
  const Vector3d value = eigen.eigenvalues().cwiseMax(0);
  return {{normal[0], normal[1], normal[2]},
          value[1] > 0 ? std::sqrt(value[0] / value[1]) : 1,
          value[2] > 0 ? std::sqrt(value[1] / value[2]) : 0};
}

}  // namespace

SitePlanes::SitePlanes(const PointSet& set, double distance) : set_(set), reach_(kReach * distance) {}

SitePlane SitePlanes::at(const Vec3& centre) {
  index_.clear();
  if (reach_ > 0) set_.tree().within(centre, reach_, index_);
  return through_found(set_, centre);
}

SitePlane SitePlanes::through_some_at(const Vec3& centre, const std::vector<PointSet>& thinned) {
  if (reach_ == 0) return at(centre);
  const PointSet* set = &set_;
  set->tree().within(centre, reach_, index_, kPlaces);
  for (auto next = thinned.begin(); index_.size() > kPlaces && next != thinned.end(); ++next) {
    set = &*next;
    set->tree().within(centre, reach_, index_, kPlaces);
  }
  return through_found(*set, centre);
}

SitePlane SitePlanes::at_point(std::size_t i) {
  const auto first = set_.near().begin() + static_cast<std::ptrdiff_t>(i * set_.near_count());
  index_.assign(first, first + static_cast<std::ptrdiff_t>(std::min(kPatchNeighbours, set_.near_count())));
  std::sort(index_.begin(), index_.end());
  return fit_plane_at(set_.points(), index_, set_.points()[i]);
}

SitePlane SitePlanes::through_found(const PointSet& set, const Vec3& centre) {
  if (index_.size() < kPatchNeighbours) set.tree().nearest(centre, kPatchNeighbours, index_, squared_);
  std::sort(index_.begin(), index_.end());
  return fit_plane_at(set.points(), index_, centre);
}

}  // namespace g3r
