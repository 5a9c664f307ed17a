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

// In ascending order.
std::vector<FaceRecord> face_records(const std::vector<ActiveEdge>& edges) {
  if (edges.size() >= std::size_t{1} << 30U) throw std::bad_alloc();
  std::vector<FaceRecord> records;
  records.reserve(4 * edges.size());
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint64_t a = edges[e].leaf[k], b = edges[e].leaf[(k + 1U) % 4U];
      if (a != b) records.push_back({(std::min(a, b) << 32U) | std::max(a, b), 4 * e + k, 0});
    }
  }
  parallel::sort(records.begin(), records.end(), std::less<>());
  return records;
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

// Arcs of all faces; those from `first_multiple` on come from faces with more than one.
struct Arcs {
  std::vector<FaceRecord> arcs;
  std::size_t first_multiple = 0;
};

// `complete(leaf)`: whether `edges` has all crossings on the boundary of the leaf; faces between two that are not complete have no arcs.
template <class Complete>
Arcs join_arcs(const Octree& octree, const std::vector<ActiveEdge>& edges, const Complete& complete, const InsideTest& centre_inside) {
  Arcs out;
  std::vector<FaceRecord>& records = out.arcs;  // arcs take the place of those already looked at
  records = face_records(edges);
  std::vector<AmbiguousFace> ambiguous;
  for (std::size_t i = 0; i < records.size();) {
    std::size_t j = i;
    while (j < records.size() && records[j].face == records[i].face) ++j;
    if (!complete(records[i].face >> 32U) && !complete(records[i].face & 0xffffffffU)) {
      i = j;
      continue;
    }
    if (j - i == 2) {
      records[out.first_multiple++] = {records[i].face, records[i].place, records[i + 1].place};
    } else {
      ambiguous.emplace_back(
          octree, edges,
          std::vector<FaceRecord>(records.begin() + static_cast<std::ptrdiff_t>(i), records.begin() + static_cast<std::ptrdiff_t>(j)));
    }
    i = j;
  }
  records.resize(out.first_multiple);
  if (ambiguous.empty()) return out;
  std::vector<Vec3> centres;
  centres.reserve(ambiguous.size());
  for (const AmbiguousFace& face : ambiguous) centres.push_back(face.centre());
  const std::vector<std::uint8_t> inside = centre_inside(centres);
  for (std::size_t f = 0; f < ambiguous.size(); ++f) ambiguous[f].join(inside[f] != 0, out.arcs);
  return out;
}

// ---- patches: the loops of arcs on the boundary of each leaf ----

// Patch of every (edge, place), 4 per edge; kNone in leaves that are not complete.
template <class Complete>
std::vector<std::uint32_t> label_patches(const std::vector<ActiveEdge>& edges, const std::vector<FaceRecord>& arcs,
                                         const Complete& complete, DualSurface& surface) {
  DisjointSets groups(edges.size() * 4);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (edges[e].leaf[k] == edges[e].leaf[(k + 1) % 4]) groups.join(4 * e + k, 4 * e + (k + 1) % 4);
    }
  }
  const auto place_of = [&](std::uint32_t e, std::uint32_t leaf) {
    std::uint32_t k = 0;
    while (edges[e].leaf[k] != leaf) ++k;
    return 4 * e + k;
  };
  for (const FaceRecord& arc : arcs) {
    for (const std::uint32_t leaf : {static_cast<std::uint32_t>(arc.face >> 32U), static_cast<std::uint32_t>(arc.face)}) {
      groups.join(place_of(arc.place / 4, leaf), place_of(arc.other / 4, leaf));
    }
  }
  std::vector<std::uint32_t> patch(edges.size() * 4, kNone);
  std::vector<std::size_t> count;
  for (std::uint32_t i = 0; i < patch.size(); ++i) {
    if (!complete(edges[i / 4].leaf[i % 4])) continue;
    const std::size_t root = groups.find(i);
    if (root == i) {
      patch[i] = static_cast<std::uint32_t>(surface.patch_leaf.size());
      surface.patch_leaf.push_back(edges[i / 4].leaf[i % 4]);
      count.push_back(0);
    } else {
      patch[i] = patch[root];
    }
    const bool repeated =
        i % 4 != 0 ? edges[i / 4].leaf[i % 4] == edges[i / 4].leaf[i % 4 - 1] : edges[i / 4].leaf[0] == edges[i / 4].leaf[3];
    if (!repeated) ++count[patch[i]];
  }
  surface.patch_begin.assign(count.size() + 1, 0);
  for (std::size_t s = 0; s < count.size(); ++s) surface.patch_begin[s + 1] = surface.patch_begin[s] + count[s];
  surface.patch_crossings.resize(surface.patch_begin.back());
  std::vector<std::size_t> fill(surface.patch_begin.begin(), surface.patch_begin.end() - 1);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (patch[4 * e + k] != kNone && edges[e].leaf[k] != edges[e].leaf[(k + 3) % 4])
        surface.patch_crossings[fill[patch[4 * e + k]]++] = e;
    }
  }
  return patch;
}

// Two patches joined by several arcs of one face would share several mesh edges: each of these gets a vertex in its middle.
std::unordered_map<std::uint32_t, std::uint32_t> split_double_edges(const Arcs& arcs, const std::vector<std::uint32_t>& patch,
                                                                    DualSurface& surface) {
  std::unordered_map<std::uint32_t, std::uint32_t> middle;  // place -> vertex
  const auto pair_of = [&](const FaceRecord& arc) {
    const std::uint64_t a = patch[arc.place], b = patch[arc.place / 4 * 4 + (arc.place + 1) % 4];
    return (std::min(a, b) << 32U) | std::max(a, b);
  };
  for (std::size_t i = arcs.first_multiple; i < arcs.arcs.size();) {
    std::size_t j = i;
    while (j < arcs.arcs.size() && arcs.arcs[j].face == arcs.arcs[i].face) ++j;
    for (std::size_t k = i; k < j; ++k) {
      const std::uint64_t pair = pair_of(arcs.arcs[k]);
      bool repeated = false;
      for (std::size_t l = i; l < j; ++l) repeated = repeated || (l != k && pair_of(arcs.arcs[l]) == pair);
      if (!repeated) continue;
      const auto vertex = static_cast<std::uint32_t>(surface.patch_count() + surface.midpoints.size());
      surface.midpoints.push_back(
          {{static_cast<std::uint32_t>(pair >> 32U), static_cast<std::uint32_t>(pair)}, {arcs.arcs[k].place / 4, arcs.arcs[k].other / 4}});
      for (const std::uint32_t place : {arcs.arcs[k].place, arcs.arcs[k].other}) middle[place] = vertex;
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
  surface.polygon_begin.assign(1, 0);
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
    surface.polygon_begin.push_back(polygon.size());
  }
}

}  // namespace

DualSurface contour(const Octree& octree, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside,
                    const std::atomic<bool>* cancel) {
  const auto mixed = [&](std::size_t leaf) {
    const auto& c = octree.corners(leaf);
    return std::any_of(c.begin(), c.end(), [&](std::uint32_t k) { return inside[k] != inside[c[0]]; });
  };
  const auto all = [](std::size_t) { return true; };
  const auto keep = [&](const MinimalEdge& e, std::vector<ActiveEdge>& out) {
    if (inside[e.low] != inside[e.high]) out.push_back({e, inside[e.low] != 0});
  };
  const auto crossing = edges::find_edges<ActiveEdge>(octree, edges::mark_nodes(octree, mixed), keep, cancel);
  const Arcs arcs = join_arcs(octree, crossing, all, centre_inside);
  DualSurface surface;
  surface.crossings.reserve(crossing.size());
  for (const ActiveEdge& e : crossing) surface.crossings.push_back(e.inside_low ? Crossing{e.low, e.high} : Crossing{e.high, e.low});
  const std::vector<std::uint32_t> patch = label_patches(crossing, arcs.arcs, all, surface);
  const auto middle = split_double_edges(arcs, patch, surface);
  make_polygons(octree, crossing, patch, middle, surface);
  return surface;
}

std::vector<MinimalEdge> edges_around(const Octree& octree, const std::vector<std::uint8_t>& leaves, const std::atomic<bool>* cancel) {
  const auto keep = [](const MinimalEdge& e, std::vector<MinimalEdge>& out) { out.push_back(e); };
  return edges::find_edges<MinimalEdge>(octree, edges::mark_nodes(octree, [&](std::size_t leaf) { return leaves[leaf] != 0; }), keep,
                                        cancel);
}

Patches patches_in(const Octree& octree, const std::vector<MinimalEdge>& edges, const std::vector<std::uint32_t>& chosen,
                   const std::vector<std::uint8_t>& leaves, const std::vector<std::uint8_t>& inside, const InsideTest& centre_inside) {
  const auto marked = [&](std::size_t leaf) { return leaves[leaf] != 0; };
  std::vector<ActiveEdge> crossing;
  std::vector<std::uint32_t> number;
  for (const std::uint32_t k : chosen) {
    const MinimalEdge& e = edges[k];
    if (inside[e.low] == inside[e.high] || std::none_of(e.leaf.begin(), e.leaf.end(), marked)) continue;
    crossing.push_back({e, inside[e.low] != 0});
    number.push_back(k);
  }
  DualSurface surface;
  label_patches(crossing, join_arcs(octree, crossing, marked, centre_inside).arcs, marked, surface);
  for (std::uint32_t& k : surface.patch_crossings) k = number[k];
  return {std::move(surface.patch_leaf), std::move(surface.patch_begin), std::move(surface.patch_crossings)};
}

}  // namespace g3r::mesh
