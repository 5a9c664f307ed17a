// Which side of an open surface is its outside.
#pragma once

#include "orient/open_surfaces.h"
#include "orient/site_parts.h"

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r {

/// Turns the normals of open parts to their outside, and writes OpenSurfaces::part, certainty and held. That is the side on which the mean
/// of the winding field w at the part, of its own field, is positive: e / 2, with e = 1 on a closed surface, 0.62 on half a sphere, 0 on a
/// plane (SiteParts::enclosure()). Where |e| is below 1/2 either side could be it, and the one that faces up (+z; if the part is level, +y,
/// then +x) is taken. A group of sites that hardly hangs together with the rest of its part, with a chance below two thirds
/// (held_by_neighbours()), and has |e| > 1/2 by itself is a part of its own, as a ball beside the ground is. `is_open`, `enclosure`: of the
/// parts; `normals`: of the N points, with sides that agree; `found`: N values of each vector that is written. O(N log N).
void face_outside(const SiteParts& parts, const std::vector<std::uint8_t>& is_open, const std::vector<double>& enclosure,
                  std::vector<Vec3>& normals, OpenSurfaces& found);

}  // namespace g3r
