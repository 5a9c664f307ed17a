// Places where the surface bends more from one point to the next than fits can follow: narrow parts, sharp folds, the rims of thin walls.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Marks (1) the points of which a quarter of the 16 nearest are on one patch with fewer than 3 of their own 8 nearest: what lies between
/// them is a guess, and fits that make it are rough. Creases and corners between facets that points sample are not marked. `near`:
/// Neighbours::of_all(k) of the points, k >= 16; `normals`: unit. O(N).
[[nodiscard]] std::vector<std::uint8_t> undersampled_points(const std::vector<Vec3>& normals, const std::vector<std::uint32_t>& near);

}  // namespace g3r::mesh
