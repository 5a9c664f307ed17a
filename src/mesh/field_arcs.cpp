#include "mesh/field_arcs.h"

#include "base/pair_key.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <new>
#include <tuple>
#include <utility>

namespace g3r::mesh {
namespace {

// A crossing on the rim of a face.
struct RimCrossing {
  std::uint64_t face = 0;  // of Arc
  std::uint32_t place = 0;
  bool operator<(const RimCrossing& o) const { return std::tie(face, place) < std::tie(o.face, o.place); }
};

// Calls on_face(first, last) with the crossings of every face, in ascending order. As many parts of the faces as an edge has places are
// sorted one after another, so that about as many crossings as edges are in memory at the same time.
template <class OnFace>
void for_each_face(const Octree& octree, const std::vector<CrossingEdge>& edges, const OnFace& on_face) {
  std::vector<RimCrossing> crossings;
  for (std::size_t portion = 0; portion < kQuadrants; ++portion) {
    // By the lower of the two leaves.
    const std::size_t begin = octree.leaf_count() * portion / kQuadrants, end = octree.leaf_count() * (portion + 1) / kQuadrants;
    crossings.clear();
    for (std::uint32_t place = 0; place < place_of(static_cast<std::uint32_t>(edges.size()), 0); ++place) {
      const std::uint32_t a = leaf_at(edges, place), b = leaf_at(edges, next_place(place)), low = std::min(a, b);
      if (a != b && low >= begin && low < end) crossings.push_back({unordered_pair_key(a, b), place});
    }
    parallel::sort(crossings.begin(), crossings.end(), std::less<>());
    for (auto first = crossings.cbegin(); first != crossings.cend();) {
      auto last = first;
      while (last != crossings.cend() && last->face == first->face) ++last;
      on_face(first, last);
      first = last;
    }
  }
}

// A face with four or more crossings on its rim.
class AmbiguousFace {
 public:
  AmbiguousFace(const Octree& octree, const std::vector<CrossingEdge>& edges, std::vector<RimCrossing> rim) : rim_(std::move(rim)) {
    const CrossingEdge& first = edges[edge_of(rim_[0].place)];
    // Leaves 0 and 1 around an edge, and 2 and 3, are apart along the next axis.
    const std::uint32_t normal = (first.axis + 1 + turn_of(rim_[0].place) % 2) % 3;
    p_ = (normal + 1) % 3;
    q_ = (normal + 2) % 3;
    const OctreeNode a = octree.leaf(first_of(rim_[0].face)), b = octree.leaf(second_of(rim_[0].face));
    const OctreeNode& small = a.level >= b.level ? a : b;
    low_ = small.low;
    extent_ = octree.extent(small);
    std::array<double, 3> centre{};
    for (const std::uint32_t axis : {p_, q_}) centre[axis] = low_[axis] + 0.5 * extent_;
    centre[normal] = octree.corner_grid(first.low)[normal];
    centre_ = octree.world(centre[0], centre[1], centre[2]);
    sort_rim(octree, edges);
  }

  [[nodiscard]] const Vec3& centre() const { return centre_; }

  // If the centre is inside, the runs of outside corners are cut off, and the other way round.
  void join(bool centre_inside, std::vector<Arc>& arcs) const {
    const std::size_t n = rim_.size();
    const std::size_t shift = run_inside_ != centre_inside ? 0 : 1;
    for (std::size_t i = 0; i < n; i += 2) arcs.push_back({rim_[0].face, rim_[(i + shift) % n].place, rim_[(i + shift + 1) % n].place});
  }

 private:
  // Counter-clockwise from the lower corner.
  void sort_rim(const Octree& octree, const std::vector<CrossingEdge>& edges) {
    std::vector<std::pair<double, std::size_t>> order;
    order.reserve(rim_.size());
    for (std::size_t i = 0; i < rim_.size(); ++i) order.emplace_back(along_rim(octree, edges[edge_of(rim_[i].place)]), i);
    std::sort(order.begin(), order.end());
    std::vector<RimCrossing> sorted;
    sorted.reserve(rim_.size());
    for (const auto& [s, i] : order) sorted.push_back(rim_[i]);
    rim_ = std::move(sorted);
    // The first two sides of the rim run the way of their axes.
    const bool forward = order[0].first < 2.0 * extent_;
    run_inside_ = forward != edges[edge_of(rim_[0].place)].inside_low;
  }

  // Position of an edge's middle along the rim, from the lower corner.
  [[nodiscard]] double along_rim(const Octree& octree, const CrossingEdge& e) const {
    const auto lo = octree.corner_grid(e.low), hi = octree.corner_grid(e.high);
    const double s = extent_;
    const double x = 0.5 * (lo[p_] + hi[p_]) - low_[p_], y = 0.5 * (lo[q_] + hi[q_]) - low_[q_];
    if (e.axis == p_) return y < 0.5 * s ? x : 3 * s - x;
    return x > 0.5 * s ? s + y : 3 * s + (s - y);
  }

  std::vector<RimCrossing> rim_;
  std::uint32_t p_ = 0, q_ = 1;  // the axes of the face
  std::array<std::uint32_t, 3> low_{};
  std::uint32_t extent_ = 1;
  Vec3 centre_{};
  bool run_inside_ = false;  // the corners after the first crossing, going round
};

// An arc bounds a patch in each of the two leaves of its face.
void join_ends(const std::vector<CrossingEdge>& edges, const Arc& arc, DisjointSets& places) {
  const auto in_leaf = [&](std::uint32_t place, std::uint32_t leaf) {
    std::uint32_t k = 0;
    while (edges[edge_of(place)].leaf[k] != leaf) ++k;
    return place_of(edge_of(place), k);
  };
  for (const std::uint32_t leaf : {first_of(arc.face), second_of(arc.face)}) places.join(in_leaf(arc.from, leaf), in_leaf(arc.to, leaf));
}

}  // namespace

Arcs join_arcs(const Octree& octree, const std::vector<CrossingEdge>& edges, const LeafTest& complete, const InsideTest& centre_inside) {
  // Polygons have twice as many vertices as edges have places, at most.
  if (edges.size() > std::numeric_limits<std::uint32_t>::max() / (2 * kQuadrants)) throw std::bad_alloc();
  const std::uint32_t places = place_of(static_cast<std::uint32_t>(edges.size()), 0);
  Arcs out{DisjointSets(places), {}};
  for (std::uint32_t place = 0; place < places; ++place) {
    if (leaf_at(edges, place) == leaf_at(edges, next_place(place))) out.places.join(place, next_place(place));
  }
  std::vector<AmbiguousFace> ambiguous;
  for_each_face(octree, edges, [&](auto first, auto last) {
    if (!complete(first_of(first->face)) && !complete(second_of(first->face))) return;
    if (last - first == 2) {
      join_ends(edges, {first->face, first->place, (first + 1)->place}, out.places);
    } else {
      ambiguous.emplace_back(octree, edges, std::vector<RimCrossing>(first, last));
    }
  });
  if (ambiguous.empty()) return out;
  std::vector<Vec3> centres;
  centres.reserve(ambiguous.size());
  for (const AmbiguousFace& face : ambiguous) centres.push_back(face.centre());
  const std::vector<std::uint8_t> inside = centre_inside(centres);
  for (std::size_t f = 0; f < ambiguous.size(); ++f) ambiguous[f].join(inside[f] != 0, out.multiple);
  for (const Arc& arc : out.multiple) join_ends(edges, arc, out.places);
  return out;
}

}  // namespace g3r::mesh
