// orient() where a field of the surface is known already.
#pragma once

#include <g3r/g3r.h>

#include <vector>

namespace g3r {

/// orient(points, options, monitor), with `start` in the place of the winding gradient of the solution on a quarter of the points, where
/// the solve would begin with that (starts_coarse()); elsewhere `start` has no effect. N vectors in the order of the points, along the
/// normals, their lengths in proportion to those of one winding gradient. src/pipeline.cpp.
[[nodiscard]] Orientation orient_from(const PointsView& points, const std::vector<Vec3>& start, const Options& options,
                                      const Monitor& monitor);

}  // namespace g3r
