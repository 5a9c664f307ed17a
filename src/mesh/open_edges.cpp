#include "mesh/open_edges.h"

#include "mesh/constants.h"

#include <algorithm>

namespace g3r::mesh {
namespace {

// for_each_item(edge, use) calls use(i) for the items i of an edge. Counts, then fills.
template <class ForEachItem>
EdgeLists list_edges(std::size_t items, const std::vector<MinimalEdge>& edges, const ForEachItem& for_each_item) {
  EdgeLists out;
  out.begin.assign(items + 2, 0);
  for (const MinimalEdge& e : edges) for_each_item(e, [&](std::size_t i) { ++out.begin[i + 2]; });
  for (std::size_t i = 2; i < out.begin.size(); ++i) out.begin[i] += out.begin[i - 1];
  out.edges.resize(out.begin.back());
  for (std::uint32_t k = 0; k < edges.size(); ++k) for_each_item(edges[k], [&](std::size_t i) { out.edges[out.begin[i + 1]++] = k; });
  out.begin.pop_back();
  return out;
}

// Fills in the edges and marks the leaves around which they are.
void find_edges(const Octree& octree, const std::vector<std::uint8_t>& open, const std::atomic<bool>* cancel, OpenEdges& out) {
  std::vector<std::uint8_t> own(octree.leaf_count(), 0);  // leaves with an open corner
  for (std::size_t leaf = 0; leaf < own.size(); ++leaf) {
    for (const std::uint32_t c : octree.corners(leaf)) own[leaf] |= open[c];
  }
  out.edges = edges_around(octree, own, cancel);
  out.around = own;
  std::vector<std::uint8_t> larger(own.size(), 0);  // next to a leaf with one
  for (const MinimalEdge& e : out.edges) {
    if (open[e.low] == 0 && open[e.high] == 0) continue;
    for (const std::uint32_t leaf : e.leaf) out.around[leaf] = 1, larger[leaf] = own[leaf] == 0 ? 1 : 0;
  }
  std::vector<MinimalEdge> further = edges_around(octree, larger, cancel);
  std::erase_if(further, [&](const MinimalEdge& e) {
    return std::any_of(e.leaf.begin(), e.leaf.end(), [&](std::uint32_t leaf) { return own[leaf] != 0; });
  });
  out.edges.insert(out.edges.end(), further.begin(), further.end());
}

}  // namespace

OpenEdges open_edges(const Octree& octree, const std::vector<std::uint8_t>& open, const std::atomic<bool>* cancel) {
  OpenEdges out;
  find_edges(octree, open, cancel, out);
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
  out.around_leaf = list_edges(out.around.size(), out.edges, [&](const MinimalEdge& e, const auto& use) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (out.around[e.leaf[k]] != 0 && e.leaf[k] != e.leaf[(k + 3) % 4]) use(e.leaf[k]);
    }
  });
  return out;
}

}  // namespace g3r::mesh
