// Handles that hang on a few ambiguous octree corners: find them by the Euler characteristic, flip those corners.
//
// Related: Bischoff, Kobbelt, "Isosurface reconstruction with topology control", Pacific Graphics 2002; Wood, Hoppe, Desbrun, Schroeder,
// "Removing excess topology from isosurfaces", TOG 2004. Here the candidates are other labellings of the same corners, so that no handle is
// cut where nothing is ambiguous.
#pragma once

#include "mesh/field_contour.h"
#include "mesh/open_edges.h"

#include <atomic>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace g3r::mesh {

/// Handles of all components together. O(patches + crossings).
[[nodiscard]] long count_handles(const DualSurface& surface);

/// Other labellings of the same corners, taken where they have fewer handles. The same result for any number of threads. Works on the part
/// of the surface around the corners that a proposal may change; of the rest it knows which crossings are connected through it.
class HandleRemoval {
 public:
  /// `open`: 1 for corners that a proposal may change; `surface` = contour(octree, inside). `octree` must outlive this.
  /// O(nodes + crossings + edges near open corners). All members throw Cancelled.
  HandleRemoval(const Octree& octree, const std::vector<std::uint8_t>& open, const std::vector<std::uint8_t>& inside,
                const DualSurface& surface, InsideTest centre_inside, const std::atomic<bool>* cancel = nullptr);

  /// Where `proposal` differs from `inside` (both mark every corner of the octree), corners at edges around one leaf form a group. A group
  /// takes the proposal if the surface loses handles by it and the group has few corners for each; parts split off or added do not count as
  /// handles lost. A group that was refused is not looked at again before the surface changes next to it. Returns whether any took it, and
  /// updates `inside`, which is that of the constructor or of the last call.
  /// O(corners + edges around the groups that are looked at), and O(patches near open corners) if one could lose a handle.
  bool propose(const std::vector<std::uint8_t>& proposal, std::vector<std::uint8_t>& inside);

  /// Of contour(octree, inside) now.
  [[nodiscard]] long handles() const { return handles_; }

 private:
  // Corners where a proposal differs, those at edges around one leaf together.
  struct Groups {
    std::vector<std::uint32_t> place, of;  // of these corners among the open ones, and their groups
    std::vector<std::uint32_t> leaves;     // whose patches depend on them; group_ has their groups
    std::vector<long> size;                // corners of each
    std::vector<std::uint64_t> name;       // of each: the same for the same corners and the same patches in its leaves
  };

  void number_parts(const DualSurface& surface);
  std::size_t join_components();
  [[nodiscard]] Groups group_corners(const std::vector<std::uint8_t>& proposal, const std::vector<std::uint8_t>& inside);
  void drop_refused(Groups& groups);
  [[nodiscard]] Patches patches_of(const Groups& groups, const std::vector<std::uint8_t>& inside) const;
  [[nodiscard]] std::vector<long> gains(const Groups& groups, const Patches& changed, const std::vector<std::uint8_t>& from,
                                        const std::vector<std::uint8_t>& to) const;
  [[nodiscard]] std::vector<long> components_through(const Groups& groups) const;
  [[nodiscard]] bool can_lose(const Groups& groups, const Patches& changed, const std::vector<long>& gain,
                              const std::vector<long>& before) const;
  bool choose(const Groups& groups, const Patches& changed, const std::vector<long>& gain, std::vector<std::uint8_t>& take);
  void accept(const Groups& groups, const Patches& changed, const std::vector<std::uint8_t>& take);

  const Octree& octree_;
  InsideTest centre_inside_;
  const std::atomic<bool>* cancel_;
  const OpenEdges open_;
  std::size_t parts_ = 0;                 // of the surface elsewhere, which never changes
  std::vector<std::uint32_t> node_;       // of edges: the part it crosses, another number if it crosses between these leaves only, or kNone
  Patches patches_;                       // of the surface in these leaves
  std::vector<int> twice_;                // of leaves: what their patches add to twice the Euler characteristic
  std::vector<std::uint32_t> component_;  // of nodes
  std::size_t components_ = 0;
  long handles_ = 0;

  std::vector<std::uint32_t> group_;    // of leaves, kNone between proposals
  std::vector<std::uint32_t> changed_;  // of leaves: which change of the surface was the last there
  std::uint32_t changes_ = 0;
  std::unordered_set<std::uint64_t> refused_;  // names of groups
};

}  // namespace g3r::mesh
