// The planes through the surroundings of sites.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A plane through the points around a place.
struct SitePlane {
  Vec3 normal{0, 0, 1};  ///< unit vector, either side
  double flatness = 0;   ///< least principal spread over the middle one; 0: a plane, 1: a ball
  double breadth = 0;    ///< middle principal spread over the largest one; 0: a line, 1: as broad as long
};

/// Fits planes by least squares with weights 1 - r^2 / R^2 (Epanechnikov), to the points within 2.5 distances of sites, at least to the 12
/// nearest. Each thread has its own; no two may ask one at a time.
class SitePlanes {
 public:
  /// `set`: kept by reference, its tree made before parallel loops; `distance`: of the sites, 0: every point is one.
  SitePlanes(const PointSet& set, double distance);

  /// The plane at a place. O(points within reach), of 12 points at least.
  [[nodiscard]] SitePlane at(const Vec3& centre);
  /// The same, but more than 2000 points (kPlaces) are too many: the first of the `thinned` sets where so many are not, else the last,
  /// stands for them.
  [[nodiscard]] SitePlane through_some_at(const Vec3& centre, const std::vector<PointSet>& thinned);
  /// The plane of point i and its nearest, 12 in all. Asks for PointSet::near(), to be made before parallel loops. O(1).
  [[nodiscard]] SitePlane at_point(std::size_t i);

 private:
  [[nodiscard]] SitePlane through_found(const PointSet& set, const Vec3& centre);

  const PointSet& set_;
  double reach_;
  std::vector<std::uint32_t> index_;
  std::vector<double> squared_;
};

}  // namespace g3r
