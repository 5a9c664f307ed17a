#include "mesh/field_contour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <unordered_map>

#include "base/disjoint_sets.h"
#include "cpu/parallel.h"

namespace g3r::mesh {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kLeafBlock = 4096;  // leaves per parallel block
// The leaves for each edge from which on sorting the edges takes less time than counting those of every leaf.
constexpr std::size_t kFewEdges = 32;
// The independent tasks that the traversal is cut into at least, where the tree allows it: fewer would leave threads idle.
constexpr std::size_t kMinTasks = 256;

// Order of the four quadrants around an edge along axis d, counter-clockwise seen from +d: bit 0 = upper along d+1, bit 1 = along d+2.
// MinimalEdge::leaf is in this order.
constexpr std::array<std::uint32_t, 4> kCycle{0, 1, 3, 2};

struct ActiveEdge : MinimalEdge {
  bool inside_low = false;
};

// ---- traversal: minimal edges of the octree, each exactly once (Ju et al. 2002, cell, face and edge procedures) ----

enum class Kind : std::uint8_t { kCell, kFace, kEdge };

struct Task {
  Kind kind = Kind::kCell;
  std::uint8_t axis = 0;                // normal of the face, direction of the edge
  std::array<std::uint32_t, 4> node{};  // cell: 1; face: lower, upper; edge: quadrant bit 0 = upper along axis+1, bit 1 = along axis+2
};

// Marks the nodes above the leaves for which marked(leaf) is not 0.
template <class Marked>
std::vector<std::uint8_t> mark_nodes(const Octree& octree, const Marked& marked) {
  const std::vector<OctreeNode>& nodes = octree.nodes();
  std::vector<std::uint8_t> out(nodes.size(), 0);
  for (std::size_t i = nodes.size(); i-- > 0;) {  // children come after their parents
    if (nodes[i].first_child < 0) {
      out[i] = marked(static_cast<std::size_t>(nodes[i].leaf)) ? 1 : 0;
    } else {
      for (std::size_t c = 0; c < 8; ++c) out[i] |= out[static_cast<std::size_t>(nodes[i].first_child) + c];
    }
  }
  return out;
}

// The minimal edges of which some leaf around them is marked.
class Traversal {
 public:
  Traversal(const Octree& octree, std::vector<std::uint8_t> marked) : octree_(octree), marked_(std::move(marked)) {}

  // One step: the tasks below `task`, or the edge it ends at.
  template <class OnTask, class OnEdge>
  void expand(const Task& task, const OnTask& on_task, const OnEdge& on_edge) const {
    constexpr std::array<std::size_t, 3> kNodes{1, 2, 4};
    std::uint8_t some = 0;
    for (std::size_t k = 0; k < kNodes[static_cast<std::size_t>(task.kind)]; ++k) some |= marked_[task.node[k]];
    if (some == 0) return;
    switch (task.kind) {
      case Kind::kCell:
        return expand_cell(task, on_task);
      case Kind::kFace:
        return expand_face(task, on_task);
      case Kind::kEdge:
        return expand_edge(task, on_task, on_edge);
    }
  }

  template <class OnEdge>
  void run(const Task& task, const OnEdge& on_edge) const {
    expand(
        task, [&](const Task& next) { run(next, on_edge); }, on_edge);
  }

 private:
  bool internal(std::uint32_t n) const { return octree_.nodes()[n].first_child >= 0; }
  std::uint32_t child(std::uint32_t n, std::uint32_t bits) const {
    return internal(n) ? static_cast<std::uint32_t>(octree_.nodes()[n].first_child) + bits : n;
  }

  template <class OnTask>
  void expand_cell(const Task& task, const OnTask& on_task) const {
    const std::uint32_t n = task.node[0];
    if (!internal(n)) return;
    for (std::uint32_t c = 0; c < 8; ++c) on_task(Task{Kind::kCell, 0, {child(n, c)}});
    for (std::uint32_t d = 0; d < 3; ++d) {
      const std::uint32_t u = (d + 1) % 3, v = (d + 2) % 3;
      for (std::uint32_t q = 0; q < 4; ++q) {
        const std::uint32_t bits = ((q & 1U) << u) | ((q >> 1U) << v);
        on_task(Task{Kind::kFace, static_cast<std::uint8_t>(d), {child(n, bits), child(n, bits | (1U << d))}});
      }
      for (std::uint32_t k = 0; k < 2; ++k) {
        Task edge{Kind::kEdge, static_cast<std::uint8_t>(d), {}};
        for (std::uint32_t q = 0; q < 4; ++q) edge.node[q] = child(n, (k << d) | ((q & 1U) << u) | ((q >> 1U) << v));
        on_task(edge);
      }
    }
  }

  template <class OnTask>
  void expand_face(const Task& task, const OnTask& on_task) const {
    const std::array<std::uint32_t, 2> side{task.node[0], task.node[1]};
    if (!internal(side[0]) && !internal(side[1])) return;
    const std::uint32_t d = task.axis, u = (d + 1) % 3, v = (d + 2) % 3;
    for (std::uint32_t q = 0; q < 4; ++q) {
      const std::uint32_t bits = ((q & 1U) << u) | ((q >> 1U) << v);
      on_task(Task{Kind::kFace, task.axis, {child(side[0], bits | (1U << d)), child(side[1], bits)}});
    }
    for (const std::uint32_t along : {u, v}) {
      const std::uint32_t e1 = (along + 1) % 3, e2 = (along + 2) % 3;
      for (std::uint32_t k = 0; k < 2; ++k) {
        Task edge{Kind::kEdge, static_cast<std::uint8_t>(along), {}};
        for (std::uint32_t q = 0; q < 4; ++q) {
          const std::uint32_t b1 = q & 1U, b2 = q >> 1U;
          const bool upper = (e1 == d ? b1 : b2) == 1;    // which of the two sides of the face
          const std::uint32_t other = e1 == d ? b2 : b1;  // half within the face
          const std::uint32_t other_axis = e1 == d ? e2 : e1;
          const std::uint32_t bits = (k << along) | (other << other_axis) | (upper ? 0U : 1U << d);
          edge.node[q] = child(side[upper ? 1 : 0], bits);
        }
        on_task(edge);
      }
    }
  }

  template <class OnTask, class OnEdge>
  void expand_edge(const Task& task, const OnTask& on_task, const OnEdge& on_edge) const {
    const std::uint32_t d = task.axis, u = (d + 1) % 3, v = (d + 2) % 3;
    const auto bits_of = [&](std::uint32_t q) { return ((1U - (q & 1U)) << u) | ((1U - (q >> 1U)) << v); };
    if (internal(task.node[0]) || internal(task.node[1]) || internal(task.node[2]) || internal(task.node[3])) {
      for (std::uint32_t k = 0; k < 2; ++k) {
        Task half{Kind::kEdge, task.axis, {}};
        for (std::uint32_t q = 0; q < 4; ++q) half.node[q] = child(task.node[q], bits_of(q) | (k << d));
        on_task(half);
      }
      return;
    }
    std::uint32_t smallest = 0;
    for (std::uint32_t q = 1; q < 4; ++q) {
      if (octree_.nodes()[task.node[q]].level > octree_.nodes()[task.node[smallest]].level) smallest = q;
    }
    const auto& corners = octree_.corners(static_cast<std::size_t>(octree_.nodes()[task.node[smallest]].leaf));
    MinimalEdge edge;
    edge.low = corners[bits_of(smallest)];
    edge.high = corners[bits_of(smallest) | (1U << d)];
    edge.axis = task.axis;
    for (std::size_t k = 0; k < 4; ++k) edge.leaf[k] = static_cast<std::uint32_t>(octree_.nodes()[task.node[kCycle[k]]].leaf);
    on_edge(edge);
  }

  const Octree& octree_;
  std::vector<std::uint8_t> marked_;
};

// Hands the minimal edges with a marked leaf around them to keep(edge, out), which may append to `out`, and returns all that it did.
template <class Out, class Keep>
std::vector<Out> find_edges(const Octree& octree, std::vector<std::uint8_t> marked, const Keep& keep, const std::atomic<bool>* cancel) {
  const Traversal traversal(octree, std::move(marked));
  std::vector<Out> edges;
  std::vector<Task> tasks{Task{}};
  for (int round = 0; round < 12 && !tasks.empty() && tasks.size() < kMinTasks; ++round) {
    std::vector<Task> next;
    for (const Task& task : tasks) {
      traversal.expand(
          task, [&](const Task& t) { next.push_back(t); }, [&](const MinimalEdge& e) { keep(e, edges); });
    }
    tasks = std::move(next);
  }
  std::vector<std::vector<Out>> found(tasks.size());
  parallel::for_each(
      tasks.size(), [&](std::size_t t) { traversal.run(tasks[t], [&](const MinimalEdge& e) { keep(e, found[t]); }); }, cancel);
  std::size_t count = edges.size();
  for (const auto& part : found) count += part.size();
  edges.reserve(count);
  for (auto& part : found) {
    edges.insert(edges.end(), part.begin(), part.end());
    std::vector<Out>().swap(part);  // not all twice in memory
  }
  return edges;
}

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
std::vector<FaceRecord> face_records(const Octree& octree, const std::vector<ActiveEdge>& edges) {
  if (edges.size() >= std::size_t{1} << 30U) throw std::bad_alloc();
  const auto for_each_record = [&](const auto& use) {
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint64_t a = edges[e].leaf[k], b = edges[e].leaf[(k + 1U) % 4U];
        if (a != b) use(FaceRecord{(std::min(a, b) << 32U) | std::max(a, b), 4 * e + k, 0});
      }
    }
  };
  if (edges.size() < octree.leaf_count() / kFewEdges) {
    std::vector<FaceRecord> few;
    for_each_record([&](const FaceRecord& r) { few.push_back(r); });
    std::sort(few.begin(), few.end());
    return few;
  }
  // By the first leaf of the face, then each leaf's few.
  std::vector<std::uint32_t> begin(octree.leaf_count() + 2, 0);
  for_each_record([&](const FaceRecord& r) { ++begin[(r.face >> 32U) + 2]; });
  for (std::size_t l = 2; l < begin.size(); ++l) begin[l] += begin[l - 1];
  std::vector<FaceRecord> records(begin.back());
  for_each_record([&](const FaceRecord& r) { records[begin[(r.face >> 32U) + 1]++] = r; });
  parallel::for_blocks(octree.leaf_count(), kLeafBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t l = first; l < last; ++l) {
      std::sort(records.begin() + static_cast<std::ptrdiff_t>(begin[l]), records.begin() + static_cast<std::ptrdiff_t>(begin[l + 1]));
    }
  });
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
    const auto node = [&](std::uint64_t leaf) { return octree.nodes()[octree.leaf_nodes()[leaf]]; };
    const OctreeNode a = node(rim_[0].face >> 32U), b = node(rim_[0].face & 0xffffffffU);
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
  records = face_records(octree, edges);
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

// ---- sheets: the loops of arcs on the boundary of each leaf ----

// Sheet of every (edge, place), 4 per edge; kNone in leaves that are not complete.
template <class Complete>
std::vector<std::uint32_t> label_sheets(const std::vector<ActiveEdge>& edges, const std::vector<FaceRecord>& arcs, const Complete& complete,
                                        DualSurface& surface) {
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
  std::vector<std::uint32_t> sheet(edges.size() * 4, kNone);
  std::vector<std::size_t> count;
  for (std::uint32_t i = 0; i < sheet.size(); ++i) {
    if (!complete(edges[i / 4].leaf[i % 4])) continue;
    const std::size_t root = groups.find(i);
    if (root == i) {
      sheet[i] = static_cast<std::uint32_t>(surface.patch_leaf.size());
      surface.patch_leaf.push_back(edges[i / 4].leaf[i % 4]);
      count.push_back(0);
    } else {
      sheet[i] = sheet[root];
    }
    const bool repeated =
        i % 4 != 0 ? edges[i / 4].leaf[i % 4] == edges[i / 4].leaf[i % 4 - 1] : edges[i / 4].leaf[0] == edges[i / 4].leaf[3];
    if (!repeated) ++count[sheet[i]];
  }
  surface.patch_begin.assign(count.size() + 1, 0);
  for (std::size_t s = 0; s < count.size(); ++s) surface.patch_begin[s + 1] = surface.patch_begin[s] + count[s];
  surface.patch_crossings.resize(surface.patch_begin.back());
  std::vector<std::size_t> fill(surface.patch_begin.begin(), surface.patch_begin.end() - 1);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (sheet[4 * e + k] != kNone && edges[e].leaf[k] != edges[e].leaf[(k + 3) % 4])
        surface.patch_crossings[fill[sheet[4 * e + k]]++] = e;
    }
  }
  return sheet;
}

// Two sheets joined by several arcs of one face would share several mesh edges: each of these gets a vertex in its middle.
std::unordered_map<std::uint32_t, std::uint32_t> split_double_edges(const Arcs& arcs, const std::vector<std::uint32_t>& sheet,
                                                                    DualSurface& surface) {
  std::unordered_map<std::uint32_t, std::uint32_t> middle;  // place -> vertex
  const auto pair_of = [&](const FaceRecord& arc) {
    const std::uint64_t a = sheet[arc.place], b = sheet[arc.place / 4 * 4 + (arc.place + 1) % 4];
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
  const OctreeNode& a = octree.nodes()[octree.leaf_nodes()[leaf_a]];
  const OctreeNode& b = octree.nodes()[octree.leaf_nodes()[leaf_b]];
  const std::uint32_t low = std::max(a.low[e.axis], b.low[e.axis]);
  const std::uint32_t high = std::min(a.low[e.axis] + octree.extent(a), b.low[e.axis] + octree.extent(b));
  return low == octree.corner_grid(e.low)[e.axis] && high == octree.corner_grid(e.high)[e.axis];
}

void make_polygons(const Octree& octree, const std::vector<ActiveEdge>& edges, const std::vector<std::uint32_t>& sheet,
                   const std::unordered_map<std::uint32_t, std::uint32_t>& middle, DualSurface& surface) {
  surface.polygon_begin.assign(1, 0);
  surface.polygon_vertices.reserve(edges.size() * 4);
  surface.safe_diagonals.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const ActiveEdge& e = edges[i];
    const auto first = static_cast<std::ptrdiff_t>(surface.polygon_vertices.size());
    std::vector<std::uint32_t>& polygon = surface.polygon_vertices;
    for (std::size_t k = 0; k < 4; ++k) {
      if (e.leaf[k] != e.leaf[(k + 3) % 4]) polygon.push_back(sheet[4 * i + k]);
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
  const auto edges = find_edges<ActiveEdge>(octree, mark_nodes(octree, mixed), keep, cancel);
  const Arcs arcs = join_arcs(octree, edges, all, centre_inside);
  DualSurface surface;
  surface.crossings.reserve(edges.size());
  for (const ActiveEdge& e : edges) surface.crossings.push_back(e.inside_low ? Crossing{e.low, e.high} : Crossing{e.high, e.low});
  const std::vector<std::uint32_t> sheet = label_sheets(edges, arcs.arcs, all, surface);
  const auto middle = split_double_edges(arcs, sheet, surface);
  make_polygons(octree, edges, sheet, middle, surface);
  return surface;
}

std::vector<MinimalEdge> edges_around(const Octree& octree, const std::vector<std::uint8_t>& leaves, const std::atomic<bool>* cancel) {
  const auto keep = [](const MinimalEdge& e, std::vector<MinimalEdge>& out) { out.push_back(e); };
  return find_edges<MinimalEdge>(octree, mark_nodes(octree, [&](std::size_t leaf) { return leaves[leaf] != 0; }), keep, cancel);
}

Sheets sheets_in(const Octree& octree, const std::vector<MinimalEdge>& edges, const std::vector<std::uint32_t>& chosen,
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
  label_sheets(crossing, join_arcs(octree, crossing, marked, centre_inside).arcs, marked, surface);
  for (std::uint32_t& k : surface.patch_crossings) k = number[k];
  return {std::move(surface.patch_leaf), std::move(surface.patch_begin), std::move(surface.patch_crossings)};
}

}  // namespace g3r::mesh
