#include "mesh/field_contour.h"

#include "base/disjoint_sets.h"
#include "cpu/parallel_sort.h"
#include "mesh/constants.h"
#include "mesh/minimal_edges.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <unordered_map>

namespace g3r::mesh {
namespace {

struct ActiveEdge : MinimalEdge {
  bool inside_low = false;
};

// ---- arcs: on every octree face the crossings of its rim are joined in pairs ----

// Places 4 e to 4 e + 3 are those of the leaves around edge e. If the leaf at a place and the next one around the edge are different, they
// share a face with the edge on its rim.
struct FaceRecord {
  std::uint64_t face = 0;  // the two leaves, which share at most one face
  std::uint32_t place = 0;
  std::uint32_t other = 0;  // of an arc: where its other end is
  [[nodiscard]] std::uint32_t edge() const { return place / 4; }
  bool operator<(const FaceRecord& o) const { return face != o.face ? face < o.face : place < o.place; }
};

// All at once take more memory than the surface; so many times over all edges take no time beside sorting.
constexpr std::size_t kGoes = 8;

// Calls on_face(first, last) with the records of every face, in ascending order.
template <class OnFace>
void for_each_face(const Octree& octree, const std::vector<ActiveEdge>& edges, const OnFace& on_face) {
  std::vector<FaceRecord> records;
  for (std::size_t go = 0; go < kGoes; ++go) {
    const std::size_t begin = octree.leaf_count() * go / kGoes,
                      end = octree.leaf_count() * (go + 1) / kGoes;  // the lower of the two leaves
    records.clear();
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint64_t a = edges[e].leaf[k], b = edges[e].leaf[(k + 1U) % 4U], low = std::min(a, b);
        if (a != b && low >= begin && low < end) records.push_back({(low << 32U) | std::max(a, b), 4 * e + k, 0});
      }
    }
    parallel::sort(records.begin(), records.end(), std::less<>());
    for (auto first = records.cbegin(); first != records.cend();) {
      auto last = first;
      while (last != records.cend() && last->face == first->face) ++last;
      on_face(first, last);
      first = last;
    }
  }
}

// A face with four or more crossings on its rim.
class AmbiguousFace {
 public:
  AmbiguousFace(const Octree& octree, const std::vector<ActiveEdge>& edges, std::vector<FaceRecord> rim) : rim_(std::move(rim)) {
    const ActiveEdge& first = edges[rim_[0].edge()];
    const std::uint32_t u = (first.axis + 1U) % 3U, v = (first.axis + 2U) % 3U;
    const std::uint32_t normal = rim_[0].place % 2 == 0 ? u : v;
    p_ = (normal + 1U) % 3U;
    q_ = (normal + 2U) % 3U;
    const OctreeNode a = octree.leaf(rim_[0].face >> 32U), b = octree.leaf(rim_[0].face & 0xffffffffU);
    const OctreeNode& small = a.level >= b.level ? a : b;
    low_ = small.low;
    extent_ = octree.extent(small);
    std::array<double, 3> centre{};
    for (const std::uint32_t axis : {p_, q_}) centre[axis] = low_[axis] + 0.5 * extent_;
    centre[normal] = octree.corner_grid(first.low)[normal];
    centre_ = octree.world(centre[0], centre[1], centre[2]);

    std::vector<std::pair<double, std::size_t>> order;
    order.reserve(rim_.size());
    for (std::size_t i = 0; i < rim_.size(); ++i) order.emplace_back(along_rim(octree, edges[rim_[i].edge()]), i);
    std::sort(order.begin(), order.end());
    std::vector<FaceRecord> sorted;
    sorted.reserve(rim_.size());
    for (const auto& [s, i] : order) sorted.push_back(rim_[i]);
    rim_ = std::move(sorted);
    // Is the run of corners after the first crossing, going round, inside?
    const ActiveEdge& e = edges[rim_[0].edge()];
    const bool forward = order[0].first < 2.0 * extent_;
    run_inside_ = forward != e.inside_low;
  }

  [[nodiscard]] const Vec3& centre() const { return centre_; }

  // If the centre is inside, the runs of outside corners are cut off, and the other way round.
  void join(bool centre_inside, std::vector<FaceRecord>& arcs) const {
    const std::size_t n = rim_.size();
    const std::size_t shift = run_inside_ != centre_inside ? 0 : 1;
    for (std::size_t i = 0; i < n; i += 2) arcs.push_back({rim_[0].face, rim_[(i + shift) % n].place, rim_[(i + shift + 1) % n].place});
  }

 private:
  // Position of an edge's middle along the rim, counter-clockwise from the lower corner.
  double along_rim(const Octree& octree, const ActiveEdge& e) const {
    const auto lo = octree.corner_grid(e.low), hi = octree.corner_grid(e.high);
    const double s = extent_;
    const double x = 0.5 * (lo[p_] + hi[p_]) - low_[p_], y = 0.5 * (lo[q_] + hi[q_]) - low_[q_];
    if (e.axis == p_) return y < 0.5 * s ? x : 3 * s - x;
    return x > 0.5 * s ? s + y : 4 * s - y;
  }

  std::vector<FaceRecord> rim_;
  std::uint32_t p_ = 0, q_ = 1;
  std::array<std::uint32_t, 3> low_{};
  std::uint32_t extent_ = 1;
  Vec3 centre_{};
  bool run_inside_ = false;
};

struct Arcs {
  DisjointSets places;               // those of one patch are together
  std::vector<FaceRecord> multiple;  // the arcs of faces with more than one
};

// `complete(leaf)`: whether `edges` has all crossings on the boundary of the leaf; faces between two that are not complete have no arcs.
template <class Complete>
Arcs join_arcs(const Octree& octree, const std::vector<ActiveEdge>& edges, const Complete& complete, const InsideTest& centre_inside) {
  if (edges.size() >= std::size_t{1} << 29U) throw std::bad_alloc();  // polygons have twice as many vertices as edges have leaves, at most
  Arcs out{DisjointSets(edges.size() * 4), {}};
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (edges[e].leaf[k] == edges[e].leaf[(k + 1) % 4]) out.places.join(4 * e + k, 4 * e + (k + 1) % 4);
    }
  }
  const auto place_of = [&](std::uint32_t e, std::uint32_t leaf) {
    std::uint32_t k = 0;
    while (edges[e].leaf[k] != leaf) ++k;
    return 4 * e + k;
  };
  const auto join = [&](const FaceRecord& arc) {
    for (const std::uint32_t leaf : {static_cast<std::uint32_t>(arc.face >> 32U), static_cast<std::uint32_t>(arc.face)}) {
      out.places.join(place_of(arc.place / 4, leaf), place_of(arc.other / 4, leaf));
    }
  };
  std::vector<AmbiguousFace> ambiguous;
  for_each_face(octree, edges, [&](auto first, auto last) {
    if (!complete(static_cast<std::uint32_t>(first->face >> 32U)) && !complete(static_cast<std::uint32_t>(first->face))) return;
    if (last - first == 2) {
      join({first->face, first->place, (first + 1)->place});
    } else {
      ambiguous.emplace_back(octree, edges, std::vector<FaceRecord>(first, last));
    }
  });
  if (ambiguous.empty()) return out;
  std::vector<Vec3> centres;
  centres.reserve(ambiguous.size());
  for (const AmbiguousFace& face : ambiguous) centres.push_back(face.centre());
  const std::vector<std::uint8_t> inside = centre_inside(centres);
  for (std::size_t f = 0; f < ambiguous.size(); ++f) ambiguous[f].join(inside[f] != 0, out.multiple);
  for (const FaceRecord& arc : out.multiple) join(arc);
  return out;
}

// ---- patches: the loops of arcs on the boundary of each leaf ----

// Patch of every (edge, place), 4 per edge; kNone in leaves that are not complete. `places`: of Arcs, freed.
template <class Complete>
std::vector<std::uint32_t> label_patches(const std::vector<ActiveEdge>& edges, DisjointSets& places, const Complete& complete,
                                         DualSurface& surface) {
  const auto is_repeated = [&](std::uint32_t i) { return edges[i / 4].leaf[i % 4] == edges[i / 4].leaf[(i + 3) % 4]; };
  std::vector<std::uint32_t> patch(edges.size() * 4, kNone);
  surface.patch_begin.assign(2, 0);
  for (std::uint32_t i = 0; i < patch.size(); ++i) {
    if (!complete(edges[i / 4].leaf[i % 4])) continue;
    const std::size_t root = places.find(i);
    if (root == i) {
      patch[i] = static_cast<std::uint32_t>(surface.patch_leaf.size());
      surface.patch_leaf.push_back(edges[i / 4].leaf[i % 4]);
      surface.patch_begin.push_back(0);
    } else {
      patch[i] = patch[root];
    }
    if (!is_repeated(i)) ++surface.patch_begin[patch[i] + 2];
  }
  places = DisjointSets(0);
  // Counted two places on, so that they are the beginnings once all are filled in.
  for (std::size_t p = 2; p < surface.patch_begin.size(); ++p) surface.patch_begin[p] += surface.patch_begin[p - 1];
  surface.patch_crossings.resize(surface.patch_begin.back());
  for (std::uint32_t i = 0; i < patch.size(); ++i) {
    if (patch[i] != kNone && !is_repeated(i)) surface.patch_crossings[surface.patch_begin[patch[i] + 1]++] = i / 4;
  }
  surface.patch_begin.pop_back();
  return patch;
}

// `arcs`: of faces with more than one. Two patches joined by several of one face would share several mesh edges: each of these gets a
// vertex in its middle.
std::unordered_map<std::uint32_t, std::uint32_t> split_double_edges(const std::vector<FaceRecord>& arcs,
                                                                    const std::vector<std::uint32_t>& patch, DualSurface& surface) {
  std::unordered_map<std::uint32_t, std::uint32_t> middle;  // place -> vertex
  const auto pair_of = [&](const FaceRecord& arc) {
    const std::uint64_t a = patch[arc.place], b = patch[arc.place / 4 * 4 + (arc.place + 1) % 4];
    return (std::min(a, b) << 32U) | std::max(a, b);
  };
  for (std::size_t i = 0; i < arcs.size();) {
    std::size_t j = i;
    while (j < arcs.size() && arcs[j].face == arcs[i].face) ++j;
    for (std::size_t k = i; k < j; ++k) {
      const std::uint64_t pair = pair_of(arcs[k]);
      bool repeated = false;
      for (std::size_t l = i; l < j; ++l) repeated = repeated || (l != k && pair_of(arcs[l]) == pair);
      if (!repeated) continue;
      const auto vertex = static_cast<std::uint32_t>(surface.patch_count() + surface.midpoints.size());
      surface.midpoints.push_back(
          {{static_cast<std::uint32_t>(pair >> 32U), static_cast<std::uint32_t>(pair)}, {arcs[k].place / 4, arcs[k].other / 4}});
      for (const std::uint32_t place : {arcs[k].place, arcs[k].other}) middle[place] = vertex;
    }
    i = j;
  }
  return middle;
}

// A diagonal between opposite leaves belongs to this polygon alone if the leaves touch along this edge only.
bool touch_only_here(const Octree& octree, const ActiveEdge& e, std::uint32_t leaf_a, std::uint32_t leaf_b) {
  const OctreeNode a = octree.leaf(leaf_a), b = octree.leaf(leaf_b);
  const std::uint32_t low = std::max(a.low[e.axis], b.low[e.axis]);
  const std::uint32_t high = std::min(a.low[e.axis] + octree.extent(a), b.low[e.axis] + octree.extent(b));
  return low == octree.corner_grid(e.low)[e.axis] && high == octree.corner_grid(e.high)[e.axis];
}

void make_polygons(const Octree& octree, const std::vector<ActiveEdge>& edges, const std::vector<std::uint32_t>& patch,
                   const std::unordered_map<std::uint32_t, std::uint32_t>& middle, DualSurface& surface) {
  surface.polygon_begin.reserve(edges.size() + 1);
  surface.polygon_begin.push_back(0);
  surface.polygon_vertices.reserve(edges.size() * 4);
  surface.safe_diagonals.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const ActiveEdge& e = edges[i];
    const auto first = static_cast<std::ptrdiff_t>(surface.polygon_vertices.size());
    std::vector<std::uint32_t>& polygon = surface.polygon_vertices;
    for (std::size_t k = 0; k < 4; ++k) {
      if (e.leaf[k] != e.leaf[(k + 3) % 4]) polygon.push_back(patch[4 * i + k]);
      const auto found = middle.empty() ? middle.end() : middle.find(static_cast<std::uint32_t>(4 * i + k));
      if (found != middle.end()) polygon.push_back(found->second);
    }
    if (!e.inside_low) std::reverse(polygon.begin() + first, polygon.end());
    const std::size_t size = polygon.size() - static_cast<std::size_t>(first);
    std::uint8_t safe = 0;
    const bool plain = size == 4 && std::all_of(polygon.begin() + first, polygon.end(), [&](auto v) { return v < surface.patch_count(); });
    if (plain) {
      // Reversal keeps the parity of opposite places up to the shift by one place.
      const bool even = touch_only_here(octree, e, e.leaf[0], e.leaf[2]), odd = touch_only_here(octree, e, e.leaf[1], e.leaf[3]);
      safe = static_cast<std::uint8_t>(e.inside_low ? (even ? 1 : 0) | (odd ? 2 : 0) : (odd ? 1 : 0) | (even ? 2 : 0));
    }
    surface.safe_diagonals.push_back(safe);
    surface.polygon_begin.push_back(static_cast<std::uint32_t>(polygon.size()));
  }
}

// The edges that cross.
std::vector<ActiveEdge> crossing_edges(const Octree& octree, const std::vector<std::uint8_t>& inside, const std::atomic<bool>* cancel) {
  const auto mixed = [&](std::size_t leaf) {
    const auto& c = octree.corners(leaf);
    return std::any_of(c.begin(), c.end(), [&](std::uint32_t k) { return inside[k] != inside[c[0]]; });
  };
  const auto keep = [&](const MinimalEdge& e, std::vector<ActiveEdge>& out) {
    if (inside[e.low] != inside[e.high]) out.push_back({e, inside[e.low] != 0});
  };
  return edges::find_edges<ActiveEdge>(octree, edges::mark_nodes(octree, mixed), keep, cancel);
}

bool any_leaf(std::uint32_t) { return true; }

// Fills in crossings and patches and returns the patch of every (edge, place).
std::vector<std::uint32_t> make_patches(const std::vector<ActiveEdge>& edges, Arcs& arcs, DualSurface& surface) {
  std::vector<std::uint32_t> patch = label_patches(edges, arcs.places, any_leaf, surface);
  surface.crossings.reserve(edges.size());
  for (const ActiveEdge& e : edges) surface.crossings.push_back(e.inside_low ? Crossing{e.low, e.high} : Crossing{e.high, e.low});
  return patch;
}

}  // namespace

DualSurface contour(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                    const std::atomic<bool>* cancel) {
  const std::vector<ActiveEdge> edges = crossing_edges(octree, inside, cancel);
  Arcs arcs = join_arcs(octree, edges, any_leaf, centre_inside);
  DualSurface surface;
  const std::vector<std::uint32_t> patch = make_patches(edges, arcs, surface);
  make_polygons(octree, edges, patch, split_double_edges(arcs.multiple, patch, surface), surface);
  return surface;
}

DualSurface patches_of(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                       const std::atomic<bool>* cancel) {
  const std::vector<ActiveEdge> edges = crossing_edges(octree, inside, cancel);
  Arcs arcs = join_arcs(octree, edges, any_leaf, centre_inside);
  DualSurface surface;
  (void)make_patches(edges, arcs, surface);
  return surface;
}

Patches patches_in(const Octree& octree, const std::vector<MinimalEdge>& edges, const std::vector<std::uint32_t>& chosen,
                   const LeafTest& wanted, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside) {
  std::vector<ActiveEdge> crossing;
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
