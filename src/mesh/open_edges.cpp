#include "mesh/open_edges.h"

#include "mesh/constants.h"
#include "mesh/counted_lists.h"
#include "mesh/minimal_edges.h"

#include <algorithm>
#include <utility>

namespace g3r::mesh {
namespace {

// for_each_item(edge, use) calls use(i) for the items i of an edge.
template <class ForEachItem>
EdgeLists list_edges(std::size_t items, const std::vector<MinimalEdge>& edges, const ForEachItem& for_each_item) {
  EdgeLists out;
  const auto for_each = [&](const auto& use) {
    for (std::uint32_t k = 0; k < edges.size(); ++k) for_each_item(edges[k], [&](std::size_t i) { use(i, k); });
  };
  fill_lists(items, for_each, out.begin, out.edges);
  return out;
}

}  // namespace

SomeLeaves::SomeLeaves(const std::vector<std::uint8_t>& marked) : words_(marked.size() / kBits + 1) {
  for (std::uint32_t leaf = 0; leaf < marked.size(); ++leaf) {
    Word& word = words_[leaf / kBits];
    if (leaf % kBits == 0) word.before = static_cast<std::uint32_t>(count_);
    if (marked[leaf] == 0) continue;
    word.marked |= std::uint64_t{1} << leaf % kBits;
    ++count_;
  }
}

SomeLeaves leaves_around(const Octree& octree, const std::vector<std::uint8_t>& open, const std::atomic<bool>* cancel) {
  std::vector<std::uint8_t> around(octree.leaf_count(), 0);  // leaves with an open corner
  for (std::size_t leaf = 0; leaf < around.size(); ++leaf) {
    for (const std::uint32_t c : octree.corners(leaf)) around[leaf] |= open[c];
  }
  // And larger ones next to them.
  const auto keep = [&](const MinimalEdge& e, std::vector<MinimalEdge>& out) {
    const bool is_known = std::all_of(e.leaf.begin(), e.leaf.end(), [&](std::uint32_t leaf) { return around[leaf] != 0; });
    if (!is_known && (open[e.low] != 0 || open[e.high] != 0)) out.push_back(e);
  };
  const auto is_around = [&](std::size_t leaf) { return around[leaf] != 0; };
  for (const MinimalEdge& e : edges::find_edges<MinimalEdge>(octree, edges::mark_nodes(octree, is_around), keep, cancel)) {
    for (const std::uint32_t leaf : e.leaf) around[leaf] = 1;
  }
  return SomeLeaves(around);
}

OpenEdges open_edges(const Octree& octree, const std::vector<std::uint8_t>& open, SomeLeaves around, const std::atomic<bool>* cancel) {
  OpenEdges out;
  out.around = std::move(around);
  const auto is_around = [&](std::size_t leaf) { return out.around.contains(static_cast<std::uint32_t>(leaf)); };
  const auto keep = [](const MinimalEdge& e, std::vector<MinimalEdge>& found) { found.push_back(e); };
  out.edges = edges::find_edges<MinimalEdge>(octree, edges::mark_nodes(octree, is_around), keep, cancel);
  const auto count = static_cast<std::size_t>(std::count_if(open.begin(), open.end(), [](std::uint8_t o) { return o != 0; }));
  out.corners.reserve(count);
  std::vector<std::uint32_t> place(open.size(), kNone);
  for (std::uint32_t c = 0; c < open.size(); ++c) {
    if (open[c] == 0) continue;
    place[c] = static_cast<std::uint32_t>(out.corners.size());
    out.corners.push_back(c);
  }
  out.at_corner = list_edges(out.corners.size(), out.edges, [&](const MinimalEdge& e, const auto& use) {
    for (const std::uint32_t c : {e.low, e.high}) {
      if (place[c] != kNone) use(place[c]);
    }
  });
  out.around_leaf = list_edges(out.around.count(), out.edges, [&](const MinimalEdge& e, const auto& use) {
    for (std::size_t k = 0; k < kQuadrants; ++k) {
      if (out.around.contains(e.leaf[k]) && !e.is_repeated(k)) use(out.around.number(e.leaf[k]));
    }
  });
  return out;
}

}  // namespace g3r::mesh
