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

struct Sites {
  double distance = 0;                 ///< least distance between the points that sites begin with; 0: every point is a site
  PointSet set;                        ///< M centroids of the points of each site; the square of side() is the area of a site
  std::vector<std::uint32_t> site_of;  ///< N: point -> nearest site
  std::vector<Vec3> axis;              ///< M unit normals of the planes, either side
  std::vector<double> flatness;        ///< M: least principal spread over the middle one; 0: a plane, 1: a ball
  std::vector<double> breadth;         ///< M: middle principal spread over the largest one; 0: a line, 1: as broad as long

  [[nodiscard]] std::size_t size() const { return set.size(); }
  [[nodiscard]] const std::vector<Vec3>& points() const { return set.points(); }
  [[nodiscard]] const std::vector<double>& spacing() const { return set.local_spacing(); }
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

/// The least distance of sites at which the samples are a surface and not lines: 0, or 1.5, 3, 6 ... typical spacings, such that the median
/// breadth of the planes is a half or more. Scan lines are a surface only as seen across the gaps between them. Looks at about 2000
/// places, at fewer where lines would have fewer sites, and around each at 2000 points, of which every 4th, 16th, ... stands for the
/// others where there are more; 0 where there would be fewer than 30 sites. O(N) for every distance.
[[nodiscard]] double surface_distance(const PointSet& set, const std::atomic<bool>* cancel = nullptr);

/// N values: of every point the distance of sites at which the samples around it are a surface. That of all where half of the cloud is
/// lines; else that of each place, as a spinning scanner samples the street in rings and a facade beside it densely: it grows from 0 as
/// above for the points of the sites around which most planes have a breadth of less than a half, and stays 0 where those of sites 1.5
/// spacings apart have more. Empty where at most 2 % of the points are lines then, and where lines are wires (are_wires()): they are a
/// surface everywhere. O(N log N).
[[nodiscard]] std::vector<double> surface_distances(const PointSet& set, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r
