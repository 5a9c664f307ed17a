// Sights that other points block: what lies behind them a sensor has not seen.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstdint>

namespace g3r {

/// A point of a surface that is looked at.
struct SeenPoint {
  Vec3 point{};
  Vec3 normal{};  ///< of the plane of its neighbours, to either side
  double spacing = 0;
  double lift = 0;  ///< distance from that plane from which points are of other surfaces
};
/// Its plane is that of its 12 nearest points. Other surfaces begin at 2.5 times r = sqrt(2) h, h its spacing (smoothed_spacing()), and the
/// residual of the plane, so that neither noise nor bends block anything. O(log N).
[[nodiscard]] SeenPoint seen_point(const PointSet& set, std::uint32_t i);

/// Whether other points block the sight from a place: beyond `lift` there are four points within r of it, h being theirs. So it is where
/// the sight passes through a surface, of which samples have 2 pi points there and grids four at least, and not where it passes a few
/// strays. The sight is walked by steps that skip as much as the nearest point is away, as in sphere tracing (Hart, "Sphere tracing", The
/// Visual Computer 1996), of h / 2 at least. O(log N) for each.
[[nodiscard]] bool is_blocked(const PointSet& set, const SeenPoint& seen, const Vec3& place);

}  // namespace g3r
