// The surface near any place of an oriented cloud: which points take part in its fit (mesh/local_surface.h), and with what weights.
//
// Moving least squares: Levin, "Mesh-independent surface interpolation", 2003. A point at distance d from the place has a weight
// of about exp((e^2 - d^2) / (2 (0.7 h)^2)), e being the distance of the nearest point and h the spacing there.
#pragma once

#include "cloud/neighbours.h"
#include "mesh/constants.h"
#include "mesh/local_surface.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace g3r::mesh {

/// Points with unit outward normals and the local spacing at each.
struct OrientedPoints {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  std::vector<double> spacing;
};

/// About the standard deviation in spacings of the weights of a fit to clean points, so that twice it bridges the gaps of a random sample:
/// with 1 the dragon's CD is 0.29 instead of 0.24.
inline constexpr double kWidth = kGap / 2;

class LocalFit {
 public:
  enum class Detail {
    kSurface,  ///< the fitted surface
    kSide      ///< a plane is enough where the place is clearly on one side of the surface
  };

  /// All must outlive this. `neighbours`: of the positions, `near`: its of_all(k), k > 16. O(N).
  LocalFit(const OrientedPoints& points, const Neighbours& neighbours, const std::vector<std::uint32_t>& near);

  /// The surface near `x`, fitted to the 16 nearest of the neighbours of the point nearest to it; no patch if that is farther than `reach`
  /// spacings. If `direction` is not null, points whose normals point against it are left out. O(log N).
  [[nodiscard]] LocalSurface fit(const Eigen::Vector3d& x, double reach, const Eigen::Vector3d* direction = nullptr,
                                 Detail detail = Detail::kSurface) const;

 private:
  [[nodiscard]] std::uint32_t nearest(const Eigen::Vector3d& x, double reach, double& squared) const;
  void gather(const Eigen::Vector3d& x, std::uint32_t nearest, double scale, const Eigen::Vector3d* direction,
              std::vector<FitPoint>& members) const;
  bool is_clear_of(std::uint32_t i, const Eigen::Vector3d& x, double scale, QuadraticPatch& plane) const;

  const OrientedPoints& points_;
  const std::vector<std::uint32_t>& near_;
  std::size_t count_;  // neighbours of each point
  const Neighbours& neighbours_;
  double widest_;  // spacing
};

/// Distance across the wall or gap at each point: to the nearest of its neighbours that face the other way, measured along the normal.
/// Infinite where none of the 16 nearest does. `near`: of_all(k) of the positions. O(N).
[[nodiscard]] std::vector<double> wall_thickness(const OrientedPoints& points, const std::vector<std::uint32_t>& near);

}  // namespace g3r::mesh
