// A cloud seen at a coarser scale: sites an even distance apart, and the plane through the surroundings of each.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// Distance of the sites of the first thinned scale, in typical spacings; the next are kLevelRatio times as far apart each.
inline constexpr double kFirstDistance = 1.5;
/// Sites of a scale, at least: fewer say nothing of a surface.
inline constexpr std::size_t kFewestSites = 30;
/// Width in spacings of the sites of their field where there are none: narrower shows single ones.
inline constexpr double kBetweenSites = 0.7;

/// Standard deviations between two equal Gaussians, up to which they add up to one peak: walls are distinct in the field of sites farther
/// apart than so many spacings, kernels farther apart than so many of their widths, and noisy points than so many sigma.
inline constexpr double kResolved = 2;

/// A cloud seen at one scale: M sites that stand for its N points. Lengths are in the unit of the points.
struct Sites {
  double distance = 0;                 ///< least distance between the points that sites begin with; 0: every point is a site
  PointSet set;                        ///< M centroids of the points of each site; the square of side() is the area of a site
  std::vector<std::uint32_t> site_of;  ///< N: point -> nearest site
  std::vector<Vec3> axis;              ///< M unit normals of the planes, either side
  std::vector<double> flatness;        ///< M: least principal spread over the middle one; 0: a plane, 1: a ball
  std::vector<double> breadth;         ///< M: middle principal spread over the largest one; 0: a line, 1: as broad as long

  [[nodiscard]] std::size_t size() const { return set.size(); }
  [[nodiscard]] const std::vector<Vec3>& points() const { return set.points(); }
  [[nodiscard]] const std::vector<double>& spacing() const { return set.local_spacing(); }  ///< M: local, of the sites
  /// The side of the square of surface that a site stands for: its spacing, but that of the sites around it where it is much farther from
  /// them, for the emptiness around a stray point is no surface.
  [[nodiscard]] double side(std::size_t site) const;
};

/// Takes points in canonical order as long as they are `distance` away from all taken before (a maximal Poisson disk sample), and the
/// centroids of the points nearest to each: scan lines and uneven densities become even where their gaps are no wider than that, and noise
/// is averaged. The planes are fitted to the points within 2.5 distances, weights 1 - r^2 / R^2 (Epanechnikov), at least 12 of them.
/// `distance` >= 0. O(N log N). `cancel` (may be null, here and below) ends it with Cancelled.
[[nodiscard]] Sites place_sites(const PointSet& set, double distance, const std::atomic<bool>* cancel = nullptr);

/// The same with a distance of its own for every point, N values of which only a few are different: 0 where it is a site itself. The planes
/// are those through the 12 nearest sites.
[[nodiscard]] Sites place_sites(const PointSet& set, const std::vector<double>& distance, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
