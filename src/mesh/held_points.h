// Points that no surface holds, once sides and directions are known.
#pragma once

#include "cloud/constants.h"
#include "cloud/point_set.h"

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// The share of the points above which none is a stray: where the points on the surface are no clear majority, these tests know no surface,
/// and the cloud would be lost.
inline constexpr double kMostStrays = 1 - kMostOf;

/// Marks (1) the points that the surface of the others goes through. A point is a stray
///   - if less than 3 of its 8 nearest points are on one patch with it: its distance from their plane, and theirs from its own, is at most
///     1 / sqrt(8) of the way between them and twice what is usual (the 90 % quantile over the points of such distances, for noise and
///     detail), or their normals are mirror images as they are round bends and across creases; or
///   - if its spacing is more than twice that of these 8 (geometric mean): it is alone.
/// Strays are taken out and their neighbours are tested again, until all are held. Random points that find_outliers() left among those
/// of a surface: 93 to 99 % of those farther than 1.5 spacings from it; points of clean and noisy surfaces: 0 to 0.1 %, of very uneven ones
/// under as many outliers 2 %. Fewer than 100 points have none, and if they were more than a third of the points the cloud is something
/// else, and all are held. `normals`: unit. O(N log N), once more for points near strays. Throws Cancelled.
[[nodiscard]] std::vector<std::uint8_t> held_points(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                                    const std::atomic<bool>* cancel = nullptr);
/// The same of points whose surroundings are known.
[[nodiscard]] std::vector<std::uint8_t> held_points(const PointSet& set, const std::vector<Vec3>& normals, const std::atomic<bool>* cancel);

/// The same of a part of a cloud, of which more than the part is known. Points within 12 of their spacings of where the part ends are not
/// what they are in the cloud.
struct CloudHeights {
  double usual = 0;        ///< the 90 % quantile, a length
  double stray_share = 0;  ///< of the points
};
/// Of points that stand for a cloud. O(N log N).
[[nodiscard]] CloudHeights cloud_heights(const std::vector<Vec3>& points, const std::vector<Vec3>& normals);
[[nodiscard]] std::vector<std::uint8_t> held_points(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                                    const CloudHeights& cloud, const std::atomic<bool>* cancel);

/// The least number of points of a part that is not a cluster of outliers by chance: of m random points one next to the other, about one in
/// 4^(m - 1) looks like a surface, so that among `strays` of them 1 + log_4(50 strays) are met in one of fifty clouds. 0 without strays.
[[nodiscard]] double least_points_of_a_part(std::size_t strays);

}  // namespace g3r::mesh
