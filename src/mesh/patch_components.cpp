#include "mesh/patch_components.h"

#include "base/pair_key.h"
#include "mesh/constants.h"

#include <algorithm>
#include <utility>

namespace g3r::mesh {
namespace {

// Joins the crossings around each of the patches for which use(leaf). node(crossing): its place among the sets.
template <class Node, class Use>
void join_rims(const std::vector<std::uint32_t>& leaf, const std::vector<std::uint32_t>& begin, const std::vector<std::uint32_t>& rim,
               const Node& node, const Use& use, DisjointSets& sets) {
  for (std::size_t p = 0; p < leaf.size(); ++p) {
    if (!use(leaf[p])) continue;
    const std::size_t first = node(rim[begin[p]]);
    for (std::size_t k = begin[p] + 1; k < begin[p + 1]; ++k) sets.join(first, node(rim[k]));
  }
}

template <class Use>
void join_crossings(const DualSurface& s, const Use& use, DisjointSets& sets) {
  join_rims(
      s.patch_leaf, s.patch_begin, s.patch_crossings, [](std::uint32_t crossing) { return crossing; }, use, sets);
}

// `node`: of edges.
template <class Use>
void join_nodes(const Patches& s, const std::vector<std::uint32_t>& node, const Use& use, DisjointSets& sets) {
  join_rims(
      s.leaf, s.begin, s.rim, [&](std::uint32_t edge) { return node[edge]; }, use, sets);
}

// Numbers the edges that have no node, from `nodes` on; returns how many nodes there are then.
std::uint32_t number_edges(const std::vector<std::uint32_t>& edges, std::uint32_t nodes, std::vector<std::uint32_t>& node) {
  for (const std::uint32_t edge : edges) {
    if (node[edge] == kNone) node[edge] = nodes++;
  }
  return nodes;
}

bool all_leaves(std::uint32_t) { return true; }

}  // namespace

long count_handles(const DualSurface& surface) {
  DisjointSets components(surface.crossings.size());
  join_crossings(surface, all_leaves, components);
  const long twice =
      2 * static_cast<long>(surface.patch_count() + surface.crossings.size()) - static_cast<long>(surface.patch_crossings.size());
  return handles_of(static_cast<long>(components.count()), twice);
}

SurfaceElsewhere surface_elsewhere(SomeLeaves around, DualSurface&& freed) {
  const DualSurface surface = std::move(freed);
  SurfaceElsewhere out{std::move(around), {}, 0};
  DisjointSets rest(surface.crossings.size());
  join_crossings(
      surface, [&](std::uint32_t leaf) { return !out.around.contains(leaf); }, rest);
  std::vector<std::uint8_t> in_these(surface.crossings.size(), 0);
  const auto for_each_crossing = [&](bool these, const auto& use) {
    for (std::size_t p = 0; p < surface.patch_count(); ++p) {
      if (out.around.contains(surface.patch_leaf[p]) != these) continue;
      for (std::size_t k = surface.patch_begin[p]; k < surface.patch_begin[p + 1]; ++k) use(surface.patch_crossings[k]);
    }
  };
  for_each_crossing(true, [&](std::uint32_t crossing) { in_these[crossing] = 1; });
  std::vector<std::uint32_t> number(surface.crossings.size(), kNone);
  for_each_crossing(false, [&](std::uint32_t crossing) {
    if (in_these[crossing] == 0) return;
    std::uint32_t& n = number[rest.find(crossing)];
    if (n == kNone) n = static_cast<std::uint32_t>(out.parts++);
    out.crossings.push_back({pair_key(surface.crossings[crossing].inside, surface.crossings[crossing].outside), n});
  });
  std::sort(out.crossings.begin(), out.crossings.end());
  return out;
}

PatchComponents::PatchComponents(const OpenEdges& open, const SurfaceElsewhere& elsewhere, Patches patches)
    : open_(open), elsewhere_(elsewhere), patches_(std::move(patches)) {
  number_nodes();
  join();
}

// Of the edges where the parts come to the leaves around open edges.
void PatchComponents::number_nodes() {
  const std::vector<SurfaceElsewhere::Crossing>& known = elsewhere_.crossings;
  node_.assign(open_.edges.size(), kNone);
  for (const std::uint32_t edge : patches_.rim) {
    const MinimalEdge& e = open_.edges[edge];
    if (std::all_of(e.leaf.begin(), e.leaf.end(), [&](std::uint32_t leaf) { return open_.around.contains(leaf); })) continue;
    for (const std::uint64_t k : {pair_key(e.low, e.high), pair_key(e.high, e.low)}) {
      const auto found = std::lower_bound(known.begin(), known.end(), SurfaceElsewhere::Crossing{k, 0});
      if (found != known.end() && found->corners == k) node_[edge] = found->part;
    }
  }
}

// Numbers the crossings of the patches and finds their components.
void PatchComponents::join() {
  for (std::uint32_t& n : node_) {
    if (n >= elsewhere_.parts) n = kNone;
  }
  const std::uint32_t nodes = number_edges(patches_.rim, static_cast<std::uint32_t>(elsewhere_.parts), node_);
  DisjointSets sets(nodes);
  join_nodes(patches_, node_, all_leaves, sets);
  component_.resize(nodes);
  for (std::uint32_t n = 0; n < nodes; ++n) component_[n] = static_cast<std::uint32_t>(sets.find(n));
  count_ = sets.count();
}

void PatchComponents::exchange(const Patches& changed, const LeafTest& taken) {
  Patches now;
  now.begin.push_back(0);
  const auto add = [&](const Patches& from, bool those_taken) {
    for (std::size_t p = 0; p < from.leaf.size(); ++p) {
      if (taken(from.leaf[p]) != those_taken) continue;
      now.leaf.push_back(from.leaf[p]);
      for (std::size_t k = from.begin[p]; k < from.begin[p + 1]; ++k) now.rim.push_back(from.rim[k]);
      now.begin.push_back(static_cast<std::uint32_t>(now.rim.size()));
    }
  };
  add(patches_, false);
  add(changed, true);
  patches_ = std::move(now);
  join();
}

TriedExchange::TriedExchange(const PatchComponents& now, const Patches& changed, LeafTest may_be_taken)
    : now_(now),
      changed_(changed),
      may_be_taken_(std::move(may_be_taken)),
      node_(now.node_),
      elsewhere_(number_edges(changed.rim, static_cast<std::uint32_t>(now.component_.size()), node_)) {
  join_nodes(
      now_.patches_, node_, [&](std::uint32_t leaf) { return !may_be_taken_(leaf); }, elsewhere_);
}

std::vector<std::uint32_t> TriedExchange::components(const LeafTest& taken) const {
  DisjointSets sets = elsewhere_;
  join_nodes(
      now_.patches_, node_, [&](std::uint32_t leaf) { return may_be_taken_(leaf) && !taken(leaf); }, sets);
  join_nodes(changed_, node_, taken, sets);
  std::vector<std::uint32_t> found(changed_.leaf.size(), kNone);
  for (std::size_t p = 0; p < found.size(); ++p) {
    if (taken(changed_.leaf[p])) found[p] = static_cast<std::uint32_t>(sets.find(node_[changed_.rim[changed_.begin[p]]]));
  }
  return found;
}

}  // namespace g3r::mesh
