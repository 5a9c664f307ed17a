// All pairs of points within a radius.
#pragma once

#include <g3r/points.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// The neighbours of point i are other[first[i]], ..., other[first[i + 1] - 1]; a point is its own neighbour.
struct NearPairs {
  std::vector<std::size_t> first;  ///< N + 1
  std::vector<std::uint32_t> other;
};

/// Pairs at distance < radius, in an order that depends on the points only. O(N log N + pairs). Throws Cancelled.
[[nodiscard]] NearPairs near_pairs(const std::vector<Vec3>& points, double radius, const std::atomic<bool>* cancel);

}  // namespace g3r
