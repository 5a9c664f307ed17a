// Numbers that stand for points, to tell whether points are the same: of 64 well mixed bits.
#pragma once

#include "base/hash.h"
#include "io/number_type.h"

#include <g3r/points.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace g3r::tiles {

/// The same for coordinates that are equal, or not a number at the same places.
[[nodiscard]] inline std::uint64_t point_hash(const Vec3& point) {
  std::uint64_t hash = 0;
  for (const double c : point) {
    const double one_zero = std::isnan(c) ? std::numeric_limits<double>::quiet_NaN() : c + 0.0;  // -0 is 0
    hash = mixed(hash ^ io::bits_as<std::uint64_t>(one_zero));
  }
  return hash;
}

/// What `before` points had, and one more: begins with 0, and tells their order too.
[[nodiscard]] inline std::uint64_t point_hash(std::uint64_t before, const Vec3& point) { return mixed(before ^ point_hash(point)); }

}  // namespace g3r::tiles
