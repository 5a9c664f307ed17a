// Octree corners whose signs a proposal changes, in groups that can be taken or refused on their own.
#pragma once

#include "mesh/open_edges.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_set>
#include <vector>

namespace g3r::mesh {

/// Corners where a proposal differs, those at edges around one leaf together.
struct CornerGroups {
  std::vector<std::uint32_t> place, of;  ///< of these corners among the open ones, and their groups
  std::vector<std::uint32_t> leaves;     ///< whose patches depend on them, by their numbers among those around open edges
  std::vector<long> size;                ///< corners of each
  std::vector<std::uint64_t> name;       ///< of each: the same for the same corners and the same patches in its leaves

  [[nodiscard]] std::size_t count() const { return size.size(); }
};

/// Groups the corners of one proposal after the other, and remembers which groups were refused.
class CornerGrouping {
 public:
  /// `open` must outlive this.
  explicit CornerGrouping(const OpenEdges& open);

  /// The groups of a proposal, without those that were refused and have seen no change since, and those for which may_be(corners) is not
  /// so. To be ended before the next call. O(corners + edges around the groups).
  [[nodiscard]] CornerGroups group(const std::vector<std::uint8_t>& proposal, const std::vector<std::uint8_t>& inside,
                                   const std::function<bool(long)>& may_be);
  /// The group whose corners the patches of a leaf around open edges depend on; kNone if there is none.
  [[nodiscard]] std::uint32_t at(std::uint32_t leaf) const { return group_[open_.around.number(leaf)]; }
  /// Ends a proposal: groups with take = 0 were refused, the leaves of the others have changed.
  void end(const CornerGroups& groups, const std::vector<std::uint8_t>& take);

 private:
  void drop(CornerGroups& groups, const std::function<bool(long)>& may_be);

  const OpenEdges& open_;
  std::vector<std::uint32_t> group_;    // of the leaves around open edges, kNone between proposals
  std::vector<std::uint32_t> changed_;  // of these leaves: which change of the surface was the last there
  std::uint32_t changes_ = 0;
  std::unordered_set<std::uint64_t> refused_;  // names of groups
};

}  // namespace g3r::mesh
