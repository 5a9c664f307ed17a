// Places where two surfaces pass through each other: parts that were united by putting their points together, scans that do not fit.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstddef>
#include <vector>

namespace g3r::mesh {

/// What find_crossings() finds.
struct Crossings {
  double share = 0;       ///< of the points, near a curve where two surfaces cross, 0..1
  double angle = 0;       ///< between the two, the median in degrees; 0 without any
  bool is_clear = false;  ///< so many that it is no accident
};

/// Tests 20,000 points at most, evenly from all. One is near a crossing if points around have normals of another direction, 32 degrees
/// away or more, and on the line where the planes of the two meet each of them goes on to either side: an X seen along the line. A point
/// is of the plane that is nearer to its place and to its normal, so that bumps are none. Creases, where both end, and walls that stand on
/// others, where one does, are none. Two layers of one wall are none either, as their normals are opposite. Not seen are crossings below
/// some 40 degrees, and those of surfaces that curve within 8 spacings. Solids that touch along an edge look the same. Clear: as many as a
/// curve has points that is as long as the side of a square of the same area. `normals`: N, unit. The same for any number of threads.
/// O(log N) per point that is tested.
[[nodiscard]] Crossings find_crossings(const PointSet& set, const std::vector<Vec3>& normals);

}  // namespace g3r::mesh
