// The points nearest to places, and how far they are, in units of their own.
#pragma once

#include "cloud/neighbours.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <g3r/points.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::mesh {

/// Calls use(i, point, squared distance) for each place i with the point nearest to it, in parallel. O((places + points) log points).
/// Throws Cancelled.
template <class Use>
void for_each_nearest(const std::vector<Vec3>& places, const std::vector<Vec3>& points, const Use& use,
                      const std::atomic<bool>* cancel = nullptr) {
  const Neighbours neighbours(points);
  const auto search = [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> index;
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i) {
      neighbours.nearest(places[i], 1, index, squared);
      use(i, index[0], squared[0]);
    }
  };
  parallel::for_blocks(places.size(), parallel::kSmallBlock, search, cancel);
}

/// Distance of each place to the nearest point, in units of `unit(nearest point)`. Throws Cancelled.
template <class Unit>
std::vector<double> distance_to_points(const std::vector<Vec3>& places, const std::vector<Vec3>& points, const Unit& unit,
                                       const std::atomic<bool>* cancel = nullptr) {
  std::vector<double> out(places.size());
  for_each_nearest(
      places, points, [&](std::size_t i, std::uint32_t point, double squared) { out[i] = std::sqrt(squared) / unit(point); }, cancel);
  return out;
}

}  // namespace g3r::mesh
