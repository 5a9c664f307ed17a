// The memory that the field mesher takes, before it takes it.
#pragma once

#include <cstddef>

namespace g3r {

/// The memory that field_mesh() and the rest of reconstruct() take, in bytes.
struct MeshMemory {
  std::size_t limit = 0;   ///< 0: none; looked at once the octree shows what is needed
  std::size_t needed = 0;  ///< as the octree shows
};

/// MeshMemory::needed as far as it is known before the normals: of N points of a typical spacing and noise in a box with this longest side
/// (same units), 0 where they are not known; depth 0: automatic. With walls and gaps of less than about 0.7 spacings it is up to 5 times as
/// much.
[[nodiscard]] std::size_t field_mesh_memory(std::size_t points, double spacing, double noise, double longest_side, int depth);

namespace mesh {

/// The side of the octree around points of a typical spacing in a box with this longest side: with room for all surface that is no guess,
/// and a margin beyond which all is outside, as the octree's boundary has to be.
[[nodiscard]] double octree_side(double spacing, double longest_side);

/// Fills in what so many points and leaves need. Throws Unavailable beyond the limit.
void check_memory(std::size_t points, std::size_t leaves, int depth, MeshMemory& memory);

}  // namespace mesh

}  // namespace g3r
