// What the page and the picture share: validation of a scene, and its extent.
#pragma once

#include "base/vector.h"

#include <g3r/view.h>

#include <string_view>

namespace g3r::view {

using vector::Box;
using vector::is_finite;

/// Throws InvalidInput where the contract of Scene is broken, else returns the box of the finite points and of the vertices that
/// triangles use.
Box check_scene(const Scene& scene);

/// Typical distance between neighbours, the square root of the area per point: counts occupied cells of a grid. O(N).
double estimate_spacing(const std::vector<Vec3>& points, const Box& box);

/// (1 - n . t) / 2 for unit directions of n and t: 0 agreement, 1 opposite; 1/2 if either is zero or not finite.
float normal_error(const Vec3& n, const Vec3& t);

/// n / |n|, or (0, 0, 0) if n is zero or not finite.
Vec3 unit_or_zero(const Vec3& n);

}  // namespace g3r::view
