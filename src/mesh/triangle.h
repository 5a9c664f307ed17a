// What the corners of a triangle say of it.
#pragma once

#include "base/vector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// The vertices of a triangle, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Twice the area times the normal of a triangle.
inline Vec3 twice_area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  return vector::cross(vector::subtract(b, a), vector::subtract(c, a));
}
inline Vec3 twice_area_vector(const std::vector<Vec3>& vertices, const Triangle& t) {
  return twice_area_vector(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
}

}  // namespace g3r::mesh
