// A linear octree over Morton-sorted points: flat arrays, parents before children, the nodes of one level together.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A cube of side 2^(1 - level) inside [-1, 1]^3 and the points in it.
struct OctreeNode {
  std::uint32_t begin = 0;        ///< first point
  std::uint32_t end = 0;          ///< one past the last point
  std::uint32_t first_child = 0;  ///< children are consecutive nodes
  std::uint32_t child_count = 0;  ///< 0: a leaf
  std::uint32_t parent = 0;       ///< the root is its own parent
  std::int32_t level = 0;
  std::array<std::int32_t, 3> cell{0, 0, 0};  ///< integer position of the cube at its level
  double radius = 0;                          ///< distance of its farthest point from the centre
  double width = 0;                           ///< largest mollifier width of its points

  [[nodiscard]] bool leaf() const { return child_count == 0; }
  [[nodiscard]] std::uint32_t count() const { return end - begin; }
  /// 2^-level
  [[nodiscard]] double half_side() const { return 1.0 / static_cast<double>(1U << static_cast<unsigned>(level)); }
  /// Exact.
  [[nodiscard]] Vec3 centre() const {
    const double half = half_side();
    return {(2 * cell[0] + 1) * half - 1, (2 * cell[1] + 1) * half - 1, (2 * cell[2] + 1) * half - 1};
  }
};

/// Octree over points in canonical order (cloud/canonical_cloud.h). Leaves hold at most `leaf_points`, except at the deepest level (21),
/// where the grid of the codes ends. Empty cubes have no node. O(N levels).
struct Octree {
  std::vector<OctreeNode> nodes;           ///< breadth first
  std::vector<std::uint32_t> level_begin;  ///< nodes of level l: [level_begin[l], level_begin[l + 1])
  std::vector<std::uint32_t> leaves;       ///< in point order

  [[nodiscard]] std::size_t levels() const { return level_begin.size() - 1; }
};

/// `widths`: mollifier width per point, or one for all. `leaf_points` >= 1.
[[nodiscard]] Octree build_octree(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton,
                                  const std::vector<double>& widths, std::size_t leaf_points);

/// Octree over other points (queries) in canonical order whose cubes are split exactly where `guide` splits them, with the cubes' own
/// radii. What surrounds a query then depends on its position and the guide alone, not on the queries beside it. Width 0.
[[nodiscard]] Octree build_query_octree(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Octree& guide);

}  // namespace g3r
