#include "tree/octree.h"

#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

constexpr int kMaxLevel = 21;           // bits per axis of a Morton code
constexpr std::size_t kNodeBlock = 16;  // nodes per parallel block

// Cuts a node into its non-empty octants and appends them.
void split(const std::vector<std::uint64_t>& morton, std::uint32_t index, std::vector<OctreeNode>& nodes) {
  const OctreeNode parent = nodes[index];
  const int shift = 3 * (kMaxLevel - 1 - parent.level);
  const auto octant = [&](std::uint64_t code) { return static_cast<std::uint32_t>(code >> shift & 7); };
  nodes[index].first_child = static_cast<std::uint32_t>(nodes.size());
  std::uint32_t begin = parent.begin;
  while (begin < parent.end) {
    const std::uint32_t which = octant(morton[begin]);
    const auto last = std::upper_bound(morton.begin() + begin, morton.begin() + parent.end, which,
                                       [&](std::uint32_t value, std::uint64_t code) { return value < octant(code); });
    OctreeNode child;
    child.begin = begin;
    child.end = static_cast<std::uint32_t>(last - morton.begin());
    child.parent = index;
    child.level = parent.level + 1;
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      child.cell[axis] = 2 * parent.cell[axis] + static_cast<std::int32_t>(which >> (2 - a) & 1);
    }
    nodes.push_back(child);
    ++nodes[index].child_count;
    begin = child.end;
  }
}

// Radius and width of every node. Each level looks at all points.
void measure(const std::vector<Vec3>& points, const std::vector<double>& widths, Octree& tree) {
  parallel::for_blocks(tree.nodes.size(), kNodeBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      OctreeNode& node = tree.nodes[i];
      const Vec3 centre = node.centre();
      double squared = 0;
      for (std::uint32_t p = node.begin; p < node.end; ++p) {
        const Vec3 d{points[p][0] - centre[0], points[p][1] - centre[1], points[p][2] - centre[2]};
        squared = std::max(squared, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      }
      node.radius = std::sqrt(squared);
      node.width = widths.size() == 1 ? widths[0] : *std::max_element(widths.begin() + node.begin, widths.begin() + node.end);
    }
  });
}

// Splits level by level every node that `wanted(node)` names; children start as `split` makes them.
template <class Wanted>
Octree split_while(std::size_t points, const std::vector<std::uint64_t>& morton, const Wanted& wanted) {
  Octree tree;
  OctreeNode root;
  root.end = static_cast<std::uint32_t>(points);
  tree.nodes.push_back(root);
  tree.level_begin = {0, 1};
  while (tree.levels() <= kMaxLevel) {
    const std::uint32_t begin = tree.level_begin[tree.levels() - 1];
    const std::uint32_t end = tree.level_begin[tree.levels()];
    for (std::uint32_t i = begin; i < end; ++i) {
      if (wanted(tree, i)) split(morton, i, tree.nodes);
    }
    if (tree.nodes.size() == end) break;
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.nodes.size()));
  }
  tree.nodes.shrink_to_fit();
  for (std::vector<std::uint32_t> next{0}; !next.empty();) {  // depth first
    const std::uint32_t i = next.back();
    next.pop_back();
    if (tree.nodes[i].leaf()) tree.leaves.push_back(i);
    for (std::uint32_t c = tree.nodes[i].child_count; c-- > 0;) next.push_back(tree.nodes[i].first_child + c);
  }
  return tree;
}

}  // namespace

Octree build_octree(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const std::vector<double>& widths,
                    std::size_t leaf_points) {
  Octree tree = split_while(points.size(), morton, [&](const Octree& t, std::uint32_t i) {
    return t.nodes[i].count() > leaf_points && t.nodes[i].level < kMaxLevel;
  });
  measure(points, widths, tree);
  return tree;
}

Octree build_query_octree(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Octree& guide) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> twin;  // the guide's node of the same cube, or kNone
  Octree tree = split_while(points.size(), morton, [&](const Octree& t, std::uint32_t i) {
    const OctreeNode& node = t.nodes[i];
    std::uint32_t same = i == 0 ? 0 : kNone;
    if (i > 0 && twin[node.parent] != kNone) {
      const OctreeNode& above = guide.nodes[twin[node.parent]];
      for (std::uint32_t c = above.first_child; c < above.first_child + above.child_count; ++c) {
        if (guide.nodes[c].cell == node.cell) same = c;
      }
    }
    twin.push_back(same);
    return same != kNone && !guide.nodes[same].leaf();
  });
  for (OctreeNode& node : tree.nodes) node.radius = std::sqrt(3.0) * node.half_side();
  return tree;
}

}  // namespace g3r
