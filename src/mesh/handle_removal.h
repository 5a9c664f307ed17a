// Handles that hang on a few doubtful octree corners: find them by the Euler characteristic, flip those corners.
//
// Related: Bischoff, Kobbelt, "Isosurface reconstruction with topology control", Pacific Graphics 2002; Wood, Hoppe, Desbrun, Schroeder,
// "Removing excess topology from isosurfaces", TOG 2004. Here the candidates are other readings of the same signs, so that no handle is
// cut where nothing is in doubt.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "mesh/field_contour.h"

namespace g3r::mesh {

/// Handles of all components together. O(sheets + crossings).
[[nodiscard]] long count_handles(const DualSurface& surface);

/// Other readings of the same corners, taken where they have fewer handles. The same result for any number of threads. Works on the part of
/// the surface around the corners that a proposal may change; of the rest it knows which crossings are connected through it.
class HandleRemoval {
 public:
  /// `open`: 1 for corners that a proposal may change; `surface` = contour(octree, inside). `octree` must outlive this.
  /// O(nodes + crossings + edges near open corners). All members throw Cancelled.
  HandleRemoval(const Octree& octree, const std::vector<std::uint8_t>& open, const std::vector<std::uint8_t>& inside,
                const DualSurface& surface, InsideTest centre_inside, const std::atomic<bool>* cancel = nullptr);

  /// Where `proposal` differs from `inside` (both mark every corner of the octree), corners at edges around one leaf form a group. A group
  /// takes the proposal if the surface loses handles by it and the group has few corners for each; parts split off or added do not count as
  /// handles lost. Returns whether there was one, and updates `inside`, which is that of the constructor or of the last call.
  /// O(corners + edges near open corners).
  bool propose(const std::vector<std::uint8_t>& proposal, std::vector<std::uint8_t>& inside);

  /// Of contour(octree, inside) now.
  [[nodiscard]] long handles() const { return handles_; }

 private:
  const Octree& octree_;
  InsideTest centre_inside_;
  const std::atomic<bool>* cancel_;
  std::vector<MinimalEdge> edges_;   // around all leaves with an edge that ends at an open corner
  DualSurface surface_;              // crossings and sheets in these leaves,
  std::vector<std::uint32_t> part_;  // and for each crossing the part of the rest that it belongs to
  std::size_t parts_ = 0;
  long handles_ = 0;
};

}  // namespace g3r::mesh
