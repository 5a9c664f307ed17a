// Nearest points on a device: the search of cloud/neighbours.cpp in the same tree, with the same result. Internal to src/cloud and src/gpu.
#pragma once

#include "gpu/device.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::gpu {

/// A balanced k-d tree: leaves of `leaf` points, but for the last, side by side; of every node half of the leaves, rounded down, are before
/// its cut; inner nodes, parents first.
struct SearchTree {
  std::size_t leaf;
  const std::vector<double>& points;        ///< x, y and z one field after the other: 3 N, in the order of the leaves
  const std::vector<std::uint32_t>& order;  ///< N: their indices
  const std::vector<double>& cuts;          ///< of every inner node: the last point before the cut, the first one after it, its axis
};

/// For every point the k nearest, nearest first, those as far by their index: N x k, row-major. 0 < k <= N. Within alone() of the device,
/// which has doubles. Throws DeviceError; takes 28 + 4 k bytes a point there.
[[nodiscard]] std::vector<std::uint32_t> nearest_of_all(Device& device, const SearchTree& tree, std::size_t k);

}  // namespace g3r::gpu
