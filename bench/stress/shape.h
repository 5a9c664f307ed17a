// Surfaces given by formulas: Boolean mixtures of balls, boxes, tubes, rings and waves.
#pragma once

#include <g3r/points.h>

#include <cstdint>
#include <functional>
#include <string>

namespace g3r::stress {

/// What is known of the sides of a surface.
enum class Sides {
  kKnown,   ///< the boundary of a solid
  kEither,  ///< consistent, but all of them may be turned
  kNone     ///< there is no surface
};

/// The part of { value = 0 } where `exists` holds, within the ball of radius kShapeRadius around the origin.
struct Shape {
  std::function<double(const Vec3&)> value;  ///< negative inside; changes by at most the distance between two places
  std::function<bool(const Vec3&)> exists;
  Sides sides = Sides::kKnown;
  bool seen_from_inside = false;  ///< scanners stand within the solid
};

inline constexpr double kShapeRadius = 1.8;

/// Families "solid", "shell", "wire", "patch", "terrain", "room", mixed from `parts` formulas. The same numbers give the same shape.
/// Throws InvalidInput for another family.
[[nodiscard]] Shape make_shape(const std::string& family, int parts, std::uint64_t seed);

/// Unit gradient of the value: the outward normal.
[[nodiscard]] Vec3 normal_of(const Shape& shape, const Vec3& place);

}  // namespace g3r::stress
