#include "mesh/point_parts.h"

#include "base/disjoint_sets.h"
#include "cloud/chance.h"
#include "cloud/constants.h"
#include "cloud/outliers.h"
#include "cpu/parallel.h"
#include "mesh/component_support.h"
#include "mesh/constants.h"
#include "mesh/held_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace g3r::mesh {
namespace {

// For every stray the point that it is beside, or kNone.
std::vector<std::uint32_t> points_beside(const PointSet& set, const std::vector<Vec3>& strays) {
  const std::vector<double>& spacing = set.smoothed_spacing();
  const Neighbours& tree = set.tree();
  std::vector<std::uint32_t> out(strays.size());
  parallel::for_blocks(strays.size(), parallel::kSmallBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double squared = std::numeric_limits<double>::max();
      out[k] = tree.nearest(strays[k], squared, kNone);
      if (std::sqrt(squared) > kFarSpacings * spacing[out[k]]) out[k] = kNone;
    }
  });
  return out;
}

DisjointSets join_parts(const PointSet& set) {
  const std::size_t count = std::min(kRing + 1, set.near_count());
  const std::vector<double>& spacing = set.smoothed_spacing();
  DisjointSets parts(set.size());
  for (std::uint32_t i = 0; i < set.size(); ++i) {
    const std::uint32_t* const near = set.near().data() + i * set.near_count();
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t j = near[k];
      if (std::max(spacing[i], spacing[j]) <= 2 * std::min(spacing[i], spacing[j])) parts.join(i, j);
    }
  }
  return parts;
}

// Marks the points of parts that fill space, where nearly all of the largest part is seen to be surface: noise fills space as well. Parts
// of few points bend within any neighbourhood.
std::vector<std::uint8_t> points_in_space(const PointSet& set, DisjointSets& parts, const std::vector<std::size_t>& points) {
  std::vector<std::uint8_t> out(set.size(), 0);
  std::map<std::size_t, std::vector<std::uint32_t>> members;
  for (std::uint32_t i = 0; i < set.size(); ++i) {
    const std::size_t part = parts.find(i);
    if (points[part] >= kFewestSurfacePoints) members[part].push_back(i);
  }
  const auto fewer = [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); };
  const auto largest = std::max_element(members.begin(), members.end(), fewer);
  if (members.size() < 2 || share_in_space(set, largest->second) > 1 - kNearlyAll) return out;
  for (const auto& [part, some] : members) {
    if (part == largest->first || !is_majority(share_in_space(set, some), 1)) continue;
    for (const std::uint32_t i : some) out[i] = 1;
  }
  return out;
}

}  // namespace

std::vector<std::uint8_t> points_of_parts(const PointSet& set, const std::vector<Vec3>& strays) {
  std::vector<std::uint8_t> out(set.size(), 1);
  if (set.size() < kFewestPoints) return out;
  DisjointSets parts = join_parts(set);
  std::vector<std::size_t> points(set.size(), 0), beside(set.size(), 0);
  for (std::size_t i = 0; i < set.size(); ++i) ++points[parts.find(i)];
  for (const std::uint32_t i : points_beside(set, strays)) {
    if (i != kNone) ++beside[parts.find(i)];
  }
  const std::size_t most = *std::max_element(points.begin(), points.end());
  const double least = least_points_of_a_part(strays.size());
  const std::vector<std::uint8_t> in_space = points_in_space(set, parts, points);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const std::size_t part = parts.find(i);
    if (in_space[i] != 0) out[i] = 0;
    if (points[part] < most && static_cast<double>(points[part]) < std::max(least, static_cast<double>(beside[part]))) out[i] = 0;
  }
  return out;
}

}  // namespace g3r::mesh
