// Sides and directions where the surface has no inside.
#pragma once

#include "cloud/neighbours.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A cloud whose points scatter about their surface.
struct NoisyCloud {
  const std::vector<Vec3>& points;
  const Neighbours& neighbours;  ///< of these points
  double noise;                  ///< standard deviation, > 0
  double spacing;                ///< typical_spacing()
};

struct OpenSheets {
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> sheet;  ///< N: number of the sheet a point belongs to (that of its first point) or kNone; empty: no sheets
  std::vector<float> certainty;      ///< N, of the side: 0.5 where either side could be the outside, else 1; empty: no sheets
};

/// The equations are true of the boundary of a solid. A sheet without an inside (terrain, a single wall) satisfies them too, but with area
/// vectors that lie *in* it: those along its normals give w = 0 on a plane, and only sources in the plane make it 1/2. That shows. Where
/// the points nearest to a point are plainly flat (least principal spread below 0.15 of the middle one), a normal more than 30 degrees off
/// that of their plane is wrong, and 30 wrong ones side by side make an open sheet: on 28 closed models of 5,000 and 50,000 points there
/// are at most 14, but for fins thinner than the spacing. Everything connected with them, over 8 nearest points, is done over if 2 % of it
/// is wrong, 15 % under noise (on a union of boxes with the walls inside it is 0.1 %):
///   - directions: those of the planes; where nothing is flat, no wrong point is among the 16 nearest and the given normal is within 60
///     degrees of the plane's, it is kept;
///   - sides: from neighbour to neighbour, along a minimum spanning tree of 1 - |n_i . n_j| (Hoppe et al., "Surface reconstruction from
///     unorganized points", SIGGRAPH 1992), n_i the given normals along plain planes, else those of the planes. Given ones that agree with
///     each other stay together, so that closed parts of a scene keep their sides;
///   - the whole: if two thirds of the normals along plain planes agree, their majority at least 5 % of the points, they decide; else
///     neither side is the outside, and the mean normal is turned upwards (+z; if it is level +y, then +x).
/// A component is none if half of its wrong points have another wall within 4 spacings, in front of or behind their planes. Two walls
/// closer together than that shows are told from one sheet by the kurtosis of the distances (0.87 of a Gaussian's, 0.94 from 24 points on),
/// strokes by planes that do not go on from one point to the next (cosine 0.95). `points`: the cloud or, under noise, centroids of its
/// parts; `near`: Neighbours::of_all(k) of them, k >= 17, not used under noise; `normals`: N unit vectors, changed on sheets. `noisy`
/// (null: clean): planes are then fitted to the points of that cloud within about 8 standard deviations, flat below 0.35. Fewer than 30
/// points have no sheets. O(N), with sheets O(N log N); under noise about 500 places are looked at first.
[[nodiscard]] OpenSheets find_open_sheets(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& near, const NoisyCloud* noisy,
                                          std::vector<Vec3>& normals);

}  // namespace g3r
