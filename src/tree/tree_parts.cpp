#include "tree/tree_parts.h"

#include <algorithm>

namespace g3r {
namespace {

constexpr std::size_t kPartsWanted = 64;
constexpr std::size_t kSmallestPart = 4096;  // with fewer, hardly two nodes of a part share a matrix
constexpr std::size_t kLargestPart = 16384;  // with more, the expansions of a part no longer stay in a cache
constexpr std::uint32_t kAbove = 0xffffffffu;

}  // namespace

std::size_t points_of_a_part(std::size_t points) { return std::clamp(points / kPartsWanted, kSmallestPart, kLargestPart); }

TreeParts cut_tree(const Octree& tree, std::size_t points) {
  TreeParts parts;
  const std::size_t count = tree.nodes.size();
  parts.part_of.assign(count, kAbove);
  parts.slot.assign(count, 0);
  std::vector<std::uint32_t> members;
  for (std::uint32_t i = 0; i < count; ++i) {  // parents come first
    const OctreeNode& node = tree.nodes[i];
    std::uint32_t part = i == 0 ? kAbove : parts.part_of[node.parent];
    if (part == kAbove && (node.count() <= points || node.leaf())) {
      part = static_cast<std::uint32_t>(parts.roots.size());
      parts.roots.push_back(i);
      members.push_back(0);
    }
    parts.part_of[i] = part;
    if (part != kAbove) parts.slot[i] = members[part]++;
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (parts.part_of[i] != kAbove) continue;
    parts.slot[i] = static_cast<std::uint32_t>(parts.above.size());
    parts.part_of[i] = static_cast<std::uint32_t>(parts.roots.size() + parts.above.size() / TreeParts::kNodesAbove);
    parts.above.push_back(i);
  }
  return parts;
}

}  // namespace g3r
