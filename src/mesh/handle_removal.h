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

/// Other readings of the same corners, taken where they have fewer handles. The same result for any number of threads.
class HandleRemoval {
 public:
  /// `open`: 1 for corners that a proposal may change. `octree` must outlive this. O(nodes + edges near open corners). All members throw
  /// Cancelled.
  HandleRemoval(const Octree& octree, const std::vector<std::uint8_t>& open, InsideTest centre_inside,
                const std::atomic<bool>* cancel = nullptr);

  /// `inside` and `proposal` mark every corner of the octree. Where they differ, corners at edges around one leaf form a group. A group
  /// takes the proposal if `surface` = contour(octree, inside) loses handles by it and the group has few corners for each; parts split off
  /// or added do not count as handles lost. Returns whether there was one, and updates `inside` and the crossings and sheets of `surface`,
  /// which then has no polygons. O(crossings + edges near open corners).
  bool propose(const std::vector<std::uint8_t>& proposal, std::vector<std::uint8_t>& inside, DualSurface& surface) const;

 private:
  const Octree& octree_;
  InsideTest centre_inside_;
  const std::atomic<bool>* cancel_;
  std::vector<MinimalEdge> edges_;  // around all leaves with an edge that ends at an open corner
};

}  // namespace g3r::mesh
