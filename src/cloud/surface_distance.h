// How far apart sites have to be for scan lines to be a surface.
#pragma once

#include "cloud/point_set.h"

#include <atomic>
#include <vector>

namespace g3r {

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
