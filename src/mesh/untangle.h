// Triangles that cross others, mostly folds where a vertex lies beyond a crease, and thorns: smoothed away.
#pragma once

#include <g3r/mesh.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Moves the vertices of triangles that intersect others towards the mean of their neighbours, in rounds, until none intersect or more
/// rounds do not help; keeps the best. Connectivity and all vertices more than a few rings away stay. The same result for any number of
/// threads. Returns the pairs left around those found at first (a vertex that moved may, rarely, meet a part of the surface farther off).
/// Costs one search of the whole mesh, O(F log F). `fixed`: empty, or 1 for vertices that stay where they are. Throws Cancelled.
std::size_t untangle(Mesh& mesh, const std::atomic<bool>* cancel = nullptr, const std::vector<std::uint8_t>& fixed = {});

/// Moves the vertices of edges at which triangles fold back, with a dihedral angle below 60 degrees, towards the mean of their neighbours,
/// up to three times: points hold no thorns, and thin parts lose little. Connectivity and all other vertices stay. `crossings`: how many
/// pairs may intersect in the end; around more everything stays as it was, and where that does not help, everywhere. The same result for
/// any number of threads. O(F), and with folds searches of the whole mesh, O(F log F), one to five. Throws Cancelled.
void soften_thorns(Mesh& mesh, std::size_t crossings, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
