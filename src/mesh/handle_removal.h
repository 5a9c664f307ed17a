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

/// `inside` and `proposal` mark every corner of the octree. Where they differ, corners at edges around one leaf form a group. A group takes
/// the proposal if `surface` = contour(octree, inside) loses handles by it and the group has few corners for each; parts split off or added
/// do not count as handles lost. Updates `inside` and `surface`. The same result for any number of threads. Costs a contour if something
/// changes, else O(nodes + crossings).
/// Throws Cancelled.
void remove_handles(const Octree& octree, const std::vector<std::uint8_t>& proposal, const InsideTest& centre_inside,
                    std::vector<std::uint8_t>& inside, DualSurface& surface, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
