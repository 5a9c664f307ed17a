#include "mesh/undersampled.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"
#include "mesh/lines.h"

#include <algorithm>

namespace g3r::mesh {
namespace {

std::vector<std::uint8_t> points_without_patch(const std::vector<Vec3>& normals, const std::vector<std::uint32_t>& near) {
  const std::size_t n = normals.size(), stride = near.size() / n, count = std::min(kRing + 1, stride);
  std::vector<std::uint8_t> out(n, 0);
  parallel::for_blocks(n, parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::size_t same = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t j = near[i * stride + k];
        same += j != i && vector::dot(normals[i], normals[j]) > kSamePatch ? 1 : 0;
      }
      out[i] = same < kPatchPoints ? 1 : 0;
    }
  });
  return out;
}

}  // namespace

std::vector<std::uint8_t> undersampled_points(const std::vector<Vec3>& normals, const std::vector<std::uint32_t>& near) {
  const std::size_t n = normals.size(), stride = near.size() / n, voters = std::min(kFitPoints, stride);
  const std::vector<std::uint8_t> alone = points_without_patch(normals, near);
  std::vector<std::uint8_t> out(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t votes = 0;
    for (std::size_t k = 0; k < voters; ++k) votes += alone[near[i * stride + k]];
    out[i] = static_cast<double>(votes) >= kInLines * static_cast<double>(voters) ? 1 : 0;
  }
  return out;
}

}  // namespace g3r::mesh
