// Triangles as large as the points can carry, where leaves were halved to keep the two sides of a wall or gap apart.
//
// Edges are collapsed onto one of their ends, shortest first. How far the surface goes from where it was is known from quadrics: Garland,
// Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
#pragma once

#include "mesh/field_points.h"

#include <g3r/mesh.h>

#include <atomic>
#include <vector>

namespace g3r::mesh {

/// The length of edges that need not be shorter, at each point: the shortest of plain leaves, 0.8 / sqrt(2) of the spacing on the point's
/// own side, where `size` (of sizes_to_resolve()) asked for smaller ones; 0 elsewhere. O(N).
[[nodiscard]] std::vector<double> lengths_to_carry(const Prepared& prepared, const std::vector<double>& size);

/// Collapses edges that are shorter than the lengths of the points nearest to both ends, where the surface is flat to 5 degrees and stays
/// so, within 0.3 % of that length (root mean square) of where it was, and no edge becomes longer than two lengths. `mesh`: closed;
/// closedness, manifoldness, components and genus stay. `points`: N, `lengths`: N. O(V log V). Throws Cancelled.
void coarsen(Mesh& mesh, const std::vector<Vec3>& points, const std::vector<double>& lengths, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
