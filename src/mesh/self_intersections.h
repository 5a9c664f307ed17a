// Pairs of triangles that meet.
#pragma once

#include <g3r/mesh.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

using TrianglePair = std::array<std::uint32_t, 2>;  ///< the lower index first

/// All pairs of triangles that have a point in common but no corner at the same place, in ascending order, decided exactly. Triangles
/// without area are left out. O(F log F) unless very many overlap. Throws InvalidInput like count_self_intersections(), Cancelled.
[[nodiscard]] std::vector<TrianglePair> self_intersections(const Mesh& mesh, const std::atomic<bool>* cancel = nullptr);

}  // namespace g3r::mesh
