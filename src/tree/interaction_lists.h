// Which pairs of tree nodes interact through expansions (far) and which point by point (near).
#pragma once

#include "tree/octree.h"
#include "tree/tree_parts.h"

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace g3r {

/// Position of a source node relative to a target node, shared by all pairs that need the same M2L matrix; its mirror images need it too,
/// up to signs.
struct Offset {
  std::int32_t level_difference = 0;                  ///< source level - target level
  std::array<std::int32_t, 3> displacement{0, 0, 0};  ///< target centre - source centre, in half sides of the smaller node
  bool operator==(const Offset&) const = default;

  [[nodiscard]] std::array<std::int32_t, 3> magnitude() const {
    return {std::abs(displacement[0]), std::abs(displacement[1]), std::abs(displacement[2])};
  }
  /// Bit a is set where displacement[a] is negative.
  [[nodiscard]] unsigned mirror() const {
    return (displacement[0] < 0 ? 1U : 0U) | (displacement[1] < 0 ? 2U : 0U) | (displacement[2] < 0 ? 4U : 0U);
  }
  /// Mirror images side by side.
  std::strong_ordering operator<=>(const Offset& other) const {
    if (level_difference != other.level_difference) return level_difference <=> other.level_difference;
    if (magnitude() == other.magnitude()) return mirror() <=> other.mirror();
    return magnitude() < other.magnitude() ? std::strong_ordering::less : std::strong_ordering::greater;
  }

  /// True for one of an offset and its opposite. No offset of far nodes is 0.
  [[nodiscard]] bool positive() const { return displacement > std::array<std::int32_t, 3>{0, 0, 0}; }

  /// Source centre - target centre for a target of `level`. Exact.
  [[nodiscard]] Vec3 to_source(std::size_t level) const {
    const std::size_t smaller = level + static_cast<std::size_t>(std::max(level_difference, 0));
    const double half_side = 1.0 / static_cast<double>(std::uint64_t{1} << smaller);
    return {-displacement[0] * half_side, -displacement[1] * half_side, -displacement[2] * half_side};
  }
};

/// A far pair: target's local expansion += M2L(offset) source's multipole expansion.
struct FarPair {
  std::uint32_t target;  ///< node of the target tree
  std::uint32_t source;  ///< node of the source tree
};

/// A far pair and its offset, while pairs are sorted.
struct NumberedPair {
  FarPair pair;
  std::uint32_t offset;
};

/// Consecutive far pairs of one part and one offset.
struct FarRun {
  std::uint32_t offset;  ///< index into InteractionLists::offsets
  std::uint32_t pairs;
};

/// Every (target point, source point) pair is in exactly one near list or under exactly one far pair. With the same tree on both sides the
/// lists are symmetric: (a, b) is there if and only if (b, a) is, which makes the fast sum's adjoint exact.
struct InteractionLists {
  std::vector<Offset> offsets;          ///< distinct, sorted: mirror images side by side
  TreeParts parts;                      ///< of the targets, whose far pairs are done together: one M2L matrix serves many of them
  std::vector<FarPair> far;             ///< sorted by the target's part, then offset, target, source
  std::vector<std::size_t> far_begin;   ///< far pairs of part p: [far_begin[p], far_begin[p + 1])
  std::vector<FarRun> runs;             ///< all far pairs in order
  std::vector<std::size_t> run_begin;   ///< runs of part p: [run_begin[p], run_begin[p + 1])
  std::vector<std::size_t> near_begin;  ///< near sources of the i-th target leaf: [near_begin[i], near_begin[i + 1])
  std::vector<std::uint32_t> near;      ///< source leaves, as indices into the source tree's `leaves`, ascending
};

/// Dual traversal. A pair of nodes is far if radius_t + radius_s <= opening * distance, the gap between them is at least
/// `reach` mollifier widths, and their levels differ by at most 3. opening in (0, 1); opening = 0: everything is near (direct sum).
[[nodiscard]] InteractionLists build_interaction_lists(const Octree& targets, const Octree& sources, double opening, double reach);

}  // namespace g3r
