// The solver's view of the input: finite, distinct points in the normalised box, in an order that does not depend on the input's.
#pragma once

#include "cloud/point_set.h"

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// World <-> normalised box: unit = (world - centre) * scale. The longest side of the bounding box becomes 2/1.1 (paper, section 4).
struct Frame {
  Vec3 centre{0, 0, 0};
  double scale = 1;

  /// A place in the unit frame, of the box or beyond.
  [[nodiscard]] Vec3 to_unit(const Vec3& p) const {
    return {(p[0] - centre[0]) * scale, (p[1] - centre[1]) * scale, (p[2] - centre[2]) * scale};
  }
  /// A place of the unit frame in input units.
  [[nodiscard]] Vec3 to_world(const Vec3& p) const {
    return {p[0] / scale + centre[0], p[1] / scale + centre[1], p[2] / scale + centre[2]};
  }
  [[nodiscard]] double length_to_unit(double length) const { return length * scale; }
  [[nodiscard]] double length_to_world(double length) const { return length / scale; }
};

inline constexpr double kBoxSide = 2.0 / 1.1;  ///< of the longest side in the unit frame: the paper's normalisation
inline constexpr std::uint32_t kNoPoint = UINT32_MAX;
inline constexpr std::size_t kLeastPoints = 4;  ///< distinct ones: fewer cannot enclose a volume

/// Distinct finite points in Morton order of a 2^21-cell grid over [-1, 1]^3, ties by coordinates: the same for every permutation of the
/// input.
struct CanonicalCloud {
  Frame frame;
  PointSet set;                             ///< M points in the unit box
  std::vector<std::uint32_t> point_of;      ///< N: input point -> index into points, kNoPoint if not finite
  std::vector<std::uint32_t> multiplicity;  ///< M: number of input points at this place
  std::size_t non_finite = 0;

  [[nodiscard]] const std::vector<Vec3>& points() const { return set.points(); }
  [[nodiscard]] std::size_t size() const { return set.size(); }
};

/// Whether the points fill less than half of the longest side of their frame, because far ones have been taken out: the grid and the
/// kernels have to resolve what is left. O(N).
[[nodiscard]] bool is_small_in_frame(const CanonicalCloud& cloud);

/// Whether all points lie in one plane, within kLeastSpacing: nothing says which side is outside. O(N).
[[nodiscard]] bool is_flat(const CanonicalCloud& cloud);

/// Centres, scales, drops non-finite points, merges exact duplicates and sorts. O(N).
/// Throws InvalidInput for fewer than 4 distinct finite points, or points that are all on one line.
[[nodiscard]] CanonicalCloud canonical_cloud(const PointsView& points);

/// The same of the points that are not marked in `left_out` (N, or empty: none is), on a line or not. `others`: out, the distinct finite
/// places of those that are, in the unit frame or, beyond 2^52 in it, in their direction; point_of and multiplicity number them after those
/// of the cloud. What is left out changes nothing of the cloud. O(N + n log n) for n that are left out.
[[nodiscard]] CanonicalCloud canonical_cloud(const PointsView& points, const std::vector<std::uint8_t>& left_out,
                                             std::vector<Vec3>& others);

/// Throws InvalidInput if all of these points are on one line. `outliers`: that have been left out, for the message. O(N).
void require_not_collinear(const std::vector<Vec3>& points, std::size_t outliers = 0);

}  // namespace g3r
