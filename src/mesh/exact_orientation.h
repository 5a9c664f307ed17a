// The sign of a determinant, exactly: on which side of a line or a plane a point lies.
//
// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997: a filter on the rounded
// determinant, and sums of doubles that do not overlap ("expansions") where the filter cannot tell.
#pragma once

#include <g3r/points.h>

namespace g3r {

/// Sign (-1, 0, 1) of det(b - a, c - a, d - a): 1 if a, b, c are counter-clockwise seen from d. Exact while the products of three
/// differences of coordinates neither overflow nor underflow: scale the points by a power of two to about 1 first.
[[nodiscard]] int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of the triangle a, b, c seen along the axis `axis` (0, 1, 2), exactly, under the same condition.
[[nodiscard]] int orientation_along(std::size_t axis, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace g3r
