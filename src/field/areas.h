// The areas that points with known normals stand for.
#pragma once

#include "orient/open_surfaces.h"

#include <g3r/points.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r {

/// c of area_vectors(), within 1/3 and 1.3, where the median of w over points on a closed surface is +-`level` with c = 1: normals may face
/// into the solid, as those of a room do.
[[nodiscard]] double area_factor(double level);

/// eta_i = c s_i^2 n_i, with s_i the spacing averaged over 16 neighbours and c such that the median of |w| over the points is 1/2, as it is
/// on a closed surface: points that scatter lie farther apart than their share of the surface, those of a grid closer (docs/math.md,
/// "Areas"). c is within 1/3 and 1.3, and 1 if every point is on an open surface; only the others are asked for it. Strays, which no
/// surface goes through (held_points()), have at most the typical spacing. The field of these vectors is twice to five times closer to 1
/// inside and 0 outside than that of solved ones, whose lengths vary with the sample: docs/evidence/areas.md. Points in canonical order,
/// in the unit frame. O(N log N). Throws Cancelled.
[[nodiscard]] std::vector<Vec3> area_vectors(const PointSet& set, const std::vector<Vec3>& normals, const OpenSurfaces& surfaces,
                                             const std::atomic<bool>* cancel);

}  // namespace g3r
