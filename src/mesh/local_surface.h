// The surface through some oriented points around a place: one to three smooth patches, joined by sharp creases.
//
// Each patch is a quadratic height field fitted to positions and normals together (Hermite data); points are assigned to patches by
// their normals, and patches are joined by intersection or union as in Ohtake et al., "Multi-level partition of unity implicits",
// SIGGRAPH 2003, and Fleishman et al., "Robust moving least-squares fitting with sharp features", SIGGRAPH 2005.
#pragma once

#include "cloud/quadratic_patch.h"

#include <array>
#include <vector>

#include <Eigen/Core>

namespace g3r::mesh {

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

/// The surface through the points, nearest to `x` first, at most kFitPoints of them; no patch without any. The nearest point seeds a patch,
/// which takes those with similar normals; the nearest point left seeds the next, of three points at least, or of one where two walls end
/// at it and are square to it. Several patches that do not face each other are kept only if they leave at most 5 % of the squared misfit of
/// one. `points`: with their weights; their patches are filled in. `spacing` > 0. O(points).
[[nodiscard]] LocalSurface surface_through(std::vector<FitPoint>& points, double spacing, const Eigen::Vector3d& x);

}  // namespace g3r::mesh
