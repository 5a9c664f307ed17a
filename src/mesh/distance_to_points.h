// How far places are from a cloud, in units of its own.
#pragma once

#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <g3r/points.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Distance of each place to the nearest point, in units of `unit(nearest point)`.
template <class Unit>
std::vector<double> distance_to_points(const std::vector<Vec3>& places, const std::vector<Vec3>& points, const Unit& unit) {
  const Neighbours neighbours(points);
  std::vector<double> out(places.size());
  parallel::for_blocks(places.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      neighbours.nearest(places[i], 1, index, squared);
      out[i] = std::sqrt(squared[0]) / unit(index[0]);
    }
  });
  return out;
}

}  // namespace g3r::mesh
