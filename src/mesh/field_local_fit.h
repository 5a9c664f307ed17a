// The surface near a place, fitted to the oriented points around it: one to three smooth patches, joined by sharp creases.
//
// Each patch is a quadratic height field fitted to positions and normals together (Hermite data); points are assigned to patches by
// their normals, and patches are joined by intersection or union as in Ohtake et al., "Multi-level partition of unity implicits",
// SIGGRAPH 2003, and Fleishman et al., "Robust moving least-squares fitting with sharp features", SIGGRAPH 2005.
#pragma once

#include "cloud/neighbours.h"
#include "cloud/quadratic_patch.h"

#include <g3r/points.h>

#include <array>
#include <cmath>
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

/// How two patches bound the solid between them.
enum class Joint : signed char {
  kNone,    ///< they do not meet here
  kConvex,  ///< inside = inside of both
  kConcave  ///< inside = inside of either
};

/// The patches of one place: a corner has three.
inline constexpr int kMostPatches = 3;

/// The surface around one place.
struct LocalSurface {
  int count = 0;  ///< number of patches, 0 if there is no point near; patch 0 is the nearest
  std::array<QuadraticPatch, kMostPatches> patch;
  bool walls = false;                       ///< two of the patches face away from each other or each other
  std::array<Joint, kMostPatches> joint{};  ///< of patches a < b at a + b - 1
  double spacing = 0;                       ///< local spacing h
  bool unjoined = false;  ///< two patches have the place on different sides, and whether they meet in a crease the points do not say
  bool simple = false;    ///< one patch, every point near belongs to it, and it has the place on the same side as their tangent planes

  /// Signed distance to the joined patches, positive outside; which patch it belongs to (may be null).
  double distance(const Eigen::Vector3d& x, int* active = nullptr) const;
};

/// The weight of squared slopes against squared heights in spacings: normals double the data, so that three points are enough for a fit.
inline constexpr double kSlopeWeight = 0.25;

/// About the standard deviation in spacings of the weights of a fit to clean points: with 1 the dragon's CD is 0.29 instead of 0.24
/// (docs/evidence/meshes.md).
inline constexpr double kWidth = 0.7;

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
  bool clear_of(std::uint32_t i, const Eigen::Vector3d& x, double scale, QuadraticPatch& plane) const;

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
