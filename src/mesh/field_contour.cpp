#include "mesh/field_contour.h"

#include "base/pair_key.h"
#include "mesh/constants.h"
#include "mesh/counted_lists.h"
#include "mesh/field_arcs.h"
#include "mesh/minimal_edges.h"

#include <algorithm>
#include <unordered_map>

namespace g3r::mesh {
namespace {

// ---- patches: the loops of arcs on the boundary of each leaf ----

// The patch of every place; kNone in leaves that are not complete. `places`: of Arcs, freed.
std::vector<std::uint32_t> label_patches(const std::vector<CrossingEdge>& edges, DisjointSets& places, const LeafTest& complete,
                                         DualSurface& surface) {
  const auto is_repeated = [&](std::uint32_t place) { return edges[edge_of(place)].is_repeated(turn_of(place)); };
  std::vector<std::uint32_t> patch(edges.size() * kQuadrants, kNone);
  for (std::uint32_t i = 0; i < patch.size(); ++i) {
    if (!complete(leaf_at(edges, i))) continue;
    const std::size_t root = places.find(i);
    if (root == i) {
      patch[i] = static_cast<std::uint32_t>(surface.patch_leaf.size());
      surface.patch_leaf.push_back(leaf_at(edges, i));
    } else {
      patch[i] = patch[root];
    }
  }
  places = DisjointSets(0);
  const auto for_each_crossing = [&](const auto& use) {
    for (std::uint32_t i = 0; i < patch.size(); ++i) {
      if (patch[i] != kNone && !is_repeated(i)) use(patch[i], edge_of(i));
    }
  };
  fill_lists(surface.patch_leaf.size(), for_each_crossing, surface.patch_begin, surface.patch_crossings);
  return patch;
}

// ---- polygons: the patches around each crossing ----

// The vertices in the middles of arcs, by the places of their ends. `arcs`: of faces with more than one. Two patches joined by several of
// one face would share several mesh edges: each of these gets a vertex in its middle.
std::unordered_map<std::uint32_t, std::uint32_t> split_double_edges(const std::vector<Arc>& arcs, const std::vector<std::uint32_t>& patch,
                                                                    DualSurface& surface) {
  std::unordered_map<std::uint32_t, std::uint32_t> middle;
  const auto pair_of = [&](const Arc& arc) { return unordered_pair_key(patch[arc.from], patch[next_place(arc.from)]); };
  for (auto first = arcs.begin(); first != arcs.end();) {
    const auto last = std::find_if(first, arcs.end(), [&](const Arc& arc) { return arc.face != first->face; });
    for (auto arc = first; arc != last; ++arc) {
      const std::uint64_t pair = pair_of(*arc);
      if (std::count_if(first, last, [&](const Arc& other) { return pair_of(other) == pair; }) == 1) continue;
      const auto vertex = static_cast<std::uint32_t>(surface.patch_count() + surface.midpoints.size());
      surface.midpoints.push_back({{first_of(pair), second_of(pair)}, {edge_of(arc->from), edge_of(arc->to)}});
      for (const std::uint32_t place : {arc->from, arc->to}) middle[place] = vertex;
    }
    first = last;
  }
  return middle;
}

// A diagonal between opposite leaves belongs to this polygon alone if the leaves touch along this edge only.
bool touch_only_here(const Octree& octree, const CrossingEdge& e, std::uint32_t leaf_a, std::uint32_t leaf_b) {
  const OctreeNode a = octree.leaf(leaf_a), b = octree.leaf(leaf_b);
  const std::uint32_t low = std::max(a.low[e.axis], b.low[e.axis]);
  const std::uint32_t high = std::min(a.low[e.axis] + octree.extent(a), b.low[e.axis] + octree.extent(b));
  return low == octree.corner_grid(e.low)[e.axis] && high == octree.corner_grid(e.high)[e.axis];
}

// Of DualSurface, for a polygon of the four patches in the leaves around an edge.
std::uint8_t safe_diagonals(const Octree& octree, const CrossingEdge& e) {
  // Reversal keeps the parity of opposite places up to the shift by one place.
  const bool even = touch_only_here(octree, e, e.leaf[0], e.leaf[2]), odd = touch_only_here(octree, e, e.leaf[1], e.leaf[3]);
  return static_cast<std::uint8_t>(e.inside_low ? (even ? 1 : 0) | (odd ? 2 : 0) : (odd ? 1 : 0) | (even ? 2 : 0));
}

// `middle`: of split_double_edges().
void make_polygons(const Octree& octree, const std::vector<CrossingEdge>& edges, const std::vector<std::uint32_t>& patch,
                   const std::unordered_map<std::uint32_t, std::uint32_t>& middle, DualSurface& surface) {
  surface.polygon_begin.reserve(edges.size() + 1);
  surface.polygon_begin.push_back(0);
  surface.polygon_vertices.reserve(edges.size() * kQuadrants);
  surface.safe_diagonals.reserve(edges.size());
  std::vector<std::uint32_t>& polygon = surface.polygon_vertices;
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const CrossingEdge& e = edges[i];
    const auto first = static_cast<std::ptrdiff_t>(polygon.size());
    for (std::uint32_t k = 0; k < kQuadrants; ++k) {
      if (!e.is_repeated(k)) polygon.push_back(patch[place_of(i, k)]);
      const auto found = middle.empty() ? middle.end() : middle.find(place_of(i, k));
      if (found != middle.end()) polygon.push_back(found->second);
    }
    if (!e.inside_low) std::reverse(polygon.begin() + first, polygon.end());
    const bool plain = polygon.size() - static_cast<std::size_t>(first) == kQuadrants &&
                       std::all_of(polygon.begin() + first, polygon.end(), [&](auto v) { return v < surface.patch_count(); });
    surface.safe_diagonals.push_back(plain ? safe_diagonals(octree, e) : std::uint8_t{0});
    surface.polygon_begin.push_back(static_cast<std::uint32_t>(polygon.size()));
  }
}

std::vector<CrossingEdge> crossing_edges(const Octree& octree, const std::vector<std::uint8_t>& inside, const std::atomic<bool>* cancel) {
  const auto is_crossed = [&](std::size_t leaf) {
    const auto& c = octree.corners(leaf);
    return std::any_of(c.begin(), c.end(), [&](std::uint32_t k) { return inside[k] != inside[c[0]]; });
  };
  const auto keep = [&](const MinimalEdge& e, std::vector<CrossingEdge>& out) {
    if (inside[e.low] != inside[e.high]) out.push_back({e, inside[e.low] != 0});
  };
  return edges::find_edges<CrossingEdge>(octree, edges::mark_nodes(octree, is_crossed), keep, cancel);
}

bool any_leaf(std::uint32_t) { return true; }

// Fills in crossings and patches and returns the patch of every place.
std::vector<std::uint32_t> make_patches(const std::vector<CrossingEdge>& edges, Arcs& arcs, DualSurface& surface) {
  std::vector<std::uint32_t> patch = label_patches(edges, arcs.places, any_leaf, surface);
  surface.crossings.reserve(edges.size());
  for (const CrossingEdge& e : edges) surface.crossings.push_back(e.inside_low ? Crossing{e.low, e.high} : Crossing{e.high, e.low});
  return patch;
}

}  // namespace

DualSurface contour(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                    const std::atomic<bool>* cancel) {
  const std::vector<CrossingEdge> edges = crossing_edges(octree, inside, cancel);
  Arcs arcs = join_arcs(octree, edges, any_leaf, centre_inside);
  DualSurface surface;
  const std::vector<std::uint32_t> patch = make_patches(edges, arcs, surface);
  make_polygons(octree, edges, patch, split_double_edges(arcs.multiple, patch, surface), surface);
  return surface;
}

DualSurface patches_of(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                       const std::atomic<bool>* cancel) {
  const std::vector<CrossingEdge> edges = crossing_edges(octree, inside, cancel);
  Arcs arcs = join_arcs(octree, edges, any_leaf, centre_inside);
  DualSurface surface;
  (void)make_patches(edges, arcs, surface);
  return surface;
}

Patches patches_in(const Octree& octree, const std::vector<MinimalEdge>& edges, const std::vector<std::uint32_t>& chosen,
                   const LeafTest& wanted, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside) {
  std::vector<CrossingEdge> crossing;
  std::vector<std::uint32_t> number;
  for (const std::uint32_t k : chosen) {
    const MinimalEdge& e = edges[k];
    if (inside[e.low] == inside[e.high] || std::none_of(e.leaf.begin(), e.leaf.end(), wanted)) continue;
    crossing.push_back({e, inside[e.low] != 0});
    number.push_back(k);
  }
  DualSurface surface;
  Arcs arcs = join_arcs(octree, crossing, wanted, centre_inside);
  (void)label_patches(crossing, arcs.places, wanted, surface);
  for (std::uint32_t& k : surface.patch_crossings) k = number[k];
  return {std::move(surface.patch_leaf), std::move(surface.patch_begin), std::move(surface.patch_crossings)};
}

}  // namespace g3r::mesh
