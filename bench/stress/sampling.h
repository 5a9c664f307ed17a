// Points on a shape, as scanners and samplers place them.
#pragma once

#include <g3r/points.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "shape.h"

namespace g3r::stress {

struct Sampled {
  std::vector<Vec3> points;
  double area = 0;  ///< of the surface, estimated
};

/// At most `count` points, fewer only of a surface that hardly any line meets.
///   uniform  by area             uneven  up to a hundred times denser on one side
///   lines    along the cuts with parallel planes, close along and far apart across
///   raster   where parallel lines of a square grid meet it
///   views    where lines from one to four places meet it first: what they do not see is missing
/// Throws InvalidInput for another name.
[[nodiscard]] Sampled sample(const Shape& shape, const std::string& sampling, std::size_t count, std::uint64_t seed);

}  // namespace g3r::stress
