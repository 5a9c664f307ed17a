#include "mesh/handle_removal.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "g3r/error.h"
#include "mesh/disjoint_sets.h"

namespace g3r::mesh {
namespace {

constexpr long kMostPerHandle = 60;  // corners: more are a change of shape, not of a doubtful spot
constexpr int kRounds = 4;           // groups change what others do; what has not settled by then is left as it is
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Groups of corners, those at edges around one leaf together.
struct Groups {
  std::vector<std::uint32_t> of_corner, of_leaf;  // group or kNone; of leaves whose sheets depend on the corners of a group
  std::vector<std::uint8_t> leaves;               // whether a leaf has a group
  std::vector<long> size;                         // corners of each
};

// `edges`: at least those at corners where a and b differ.
Groups group_corners(const Octree& octree, const std::vector<MinimalEdge>& edges, const std::vector<std::uint8_t>& a,
                     const std::vector<std::uint8_t>& b) {
  const auto differs = [&](std::uint32_t c) { return a[c] != b[c]; };
  Groups g;
  g.of_corner.assign(a.size(), kNone);
  g.of_leaf.assign(octree.leaf_count(), kNone);
  g.leaves.assign(octree.leaf_count(), 0);
  DisjointSets sets(a.size());
  for (const MinimalEdge& e : edges) {
    if (!differs(e.low) && !differs(e.high)) continue;
    const std::uint32_t end = differs(e.low) ? e.low : e.high;
    if (differs(e.high)) sets.join(end, e.high);
    for (const std::uint32_t leaf : e.leaf) {
      std::uint32_t& first = g.of_leaf[leaf];
      if (first == kNone) first = end;
      sets.join(first, end);
      g.leaves[leaf] = 1;
    }
  }
  for (std::uint32_t c = 0; c < a.size(); ++c) {
    if (!differs(c)) continue;
    const std::size_t first = sets.find(c);  // the smallest, so its group has a number
    if (first == c) g.size.push_back(0);
    g.of_corner[c] = first == c ? static_cast<std::uint32_t>(g.size.size() - 1) : g.of_corner[first];
    ++g.size[g.of_corner[c]];
  }
  for (std::uint32_t& leaf : g.of_leaf) {
    if (leaf != kNone) leaf = g.of_corner[leaf];
  }
  return g;
}

// Adds `sign` times twice the Euler characteristic of the part of the surface that can depend on each group. A sheet is a vertex, an arc
// an edge that belongs half to each of its two sheets, a crossing a face.
void add_characteristic(const DualSurface& s, const Groups& groups, long sign, std::vector<long>& twice) {
  for (std::size_t p = 0; p < s.patch_count(); ++p) {
    const std::uint32_t g = groups.of_leaf[s.patch_leaf[p]];
    if (g != kNone) twice[g] += sign * (2 - static_cast<long>(s.patch_begin[p + 1] - s.patch_begin[p]));
  }
  for (const Crossing& c : s.crossings) {
    const std::uint32_t g = groups.of_corner[c.inside] != kNone ? groups.of_corner[c.inside] : groups.of_corner[c.outside];
    if (g != kNone) twice[g] += 2 * sign;
  }
}

// Joins the crossings around each of the sheets for which use(leaf). `number(k)`: of crossing k among the sets.
template <class Use, class Number>
void join_crossings(const DualSurface& s, const Use& use, const Number& number, DisjointSets& sets) {
  for (std::size_t p = 0; p < s.patch_count(); ++p) {
    if (!use(s.patch_leaf[p])) continue;
    const std::size_t first = number(s.patch_crossings[s.patch_begin[p]]);
    for (std::size_t k = s.patch_begin[p] + 1; k < s.patch_begin[p + 1]; ++k) sets.join(first, number(s.patch_crossings[k]));
  }
}

// Twice the Euler characteristic, where arcs count half for each of their two sheets.
long twice_characteristic(const DualSurface& s) {
  return 2 * static_cast<long>(s.patch_count() + s.crossings.size()) - static_cast<long>(s.patch_crossings.size());
}

// Joins the crossings that belong to the same of `parts` parts.
void join_parts(const std::vector<std::uint32_t>& part, std::size_t parts, DisjointSets& sets) {
  std::vector<std::uint32_t> first(parts, kNone);
  for (std::uint32_t k = 0; k < part.size(); ++k) {
    if (part[k] == kNone) continue;
    if (first[part[k]] == kNone) first[part[k]] = k;
    sets.join(first[part[k]], k);
  }
}

long component_count(const DualSurface& s, const std::vector<std::uint32_t>& part, std::size_t parts) {
  DisjointSets components(s.crossings.size());
  join_crossings(
      s, [](std::uint32_t) { return true; }, [](std::uint32_t k) { return k; }, components);
  join_parts(part, parts, components);
  return static_cast<long>(components.count());
}

std::uint64_t key(const Crossing& c) { return std::uint64_t{c.inside} << 32U | c.outside; }

// The surface outside the leaves with a group.
class Surroundings {
 public:
  // `part`: of each crossing of the surface, the one of `parts` parts it belongs to, or kNone.
  Surroundings(const DualSurface& surface, const std::vector<std::uint32_t>& part, std::size_t parts, const Groups& groups)
      : surface_(surface), part_(part), groups_(groups), joined_(surface.crossings.size()) {
    join_parts(part, parts, joined_);
    join_crossings(
        surface, [&](std::uint32_t leaf) { return groups.leaves[leaf] == 0; }, [](std::uint32_t k) { return k; }, joined_);
    for (std::size_t p = 0; p < surface.patch_count(); ++p) {
      if (groups.leaves[surface.patch_leaf[p]] == 0) continue;
      for (std::size_t k = surface.patch_begin[p]; k < surface.patch_begin[p + 1]; ++k) {
        const std::uint32_t number = surface.patch_crossings[k];
        known_.emplace_back(key(surface.crossings[number]), number);
      }
    }
    std::sort(known_.begin(), known_.end());
  }

  // Of the surface whose sheets in the leaves with a group are `inner`: how many components pass through the leaves of each group.
  [[nodiscard]] std::vector<std::size_t> components_with(const DualSurface& inner) const {
    DisjointSets sets = joined_;
    const std::vector<std::uint32_t> number = numbers_of(inner);
    for (const std::uint32_t n : number) {
      if (n >= sets.size()) sets.add();
    }
    join_crossings(
        inner, [](std::uint32_t) { return true; }, [&](std::uint32_t k) { return number[k]; }, sets);
    std::vector<std::pair<std::uint32_t, std::size_t>> seen;
    for (std::size_t p = 0; p < inner.patch_count(); ++p)
      seen.emplace_back(groups_.of_leaf[inner.patch_leaf[p]], sets.find(number[inner.patch_crossings[inner.patch_begin[p]]]));
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    std::vector<std::size_t> count(groups_.size.size(), 0);
    for (const auto& [g, component] : seen) ++count[g];
    return count;
  }

  // Crossings and sheets of that surface, and the parts of the crossings.
  [[nodiscard]] std::pair<DualSurface, std::vector<std::uint32_t>> surface_with(const DualSurface& inner) const {
    const std::vector<std::uint32_t> number = numbers_of(inner);
    std::vector<std::uint32_t> kept(surface_.crossings.size() + inner.crossings.size(), kNone);
    DualSurface out;
    std::vector<std::uint32_t> part;
    out.patch_begin.push_back(0);
    const auto add = [&](const DualSurface& from, std::size_t patch, const auto& number_of) {
      out.patch_leaf.push_back(from.patch_leaf[patch]);
      for (std::size_t k = from.patch_begin[patch]; k < from.patch_begin[patch + 1]; ++k) {
        const std::uint32_t crossing = from.patch_crossings[k];
        const std::uint32_t before = number_of(crossing);
        std::uint32_t& n = kept[before];
        if (n == kNone) {
          n = static_cast<std::uint32_t>(out.crossings.size());
          out.crossings.push_back(from.crossings[crossing]);
          part.push_back(before < part_.size() ? part_[before] : kNone);
        }
        out.patch_crossings.push_back(n);
      }
      out.patch_begin.push_back(out.patch_crossings.size());
    };
    for (std::size_t p = 0; p < surface_.patch_count(); ++p) {
      if (groups_.leaves[surface_.patch_leaf[p]] == 0) add(surface_, p, [](std::uint32_t k) { return k; });
    }
    for (std::size_t p = 0; p < inner.patch_count(); ++p) add(inner, p, [&](std::uint32_t k) { return number[k]; });
    return {std::move(out), std::move(part)};
  }

 private:
  // The number in the surface of each crossing of `inner`; new ones are numbered on.
  [[nodiscard]] std::vector<std::uint32_t> numbers_of(const DualSurface& inner) const {
    auto next = static_cast<std::uint32_t>(surface_.crossings.size());
    std::vector<std::uint32_t> number;
    number.reserve(inner.crossings.size());
    for (const Crossing& c : inner.crossings) {
      const auto found = std::lower_bound(known_.begin(), known_.end(), std::pair{key(c), std::uint32_t{0}});
      number.push_back(found != known_.end() && found->first == key(c) ? found->second : next++);
    }
    return number;
  }

  const DualSurface& surface_;
  const std::vector<std::uint32_t>& part_;
  const Groups& groups_;
  DisjointSets joined_;                                         // its crossings
  std::vector<std::pair<std::uint64_t, std::uint32_t>> known_;  // those of leaves with a group, by their corners
};

}  // namespace

long count_handles(const DualSurface& surface) { return component_count(surface, {}, 0) - twice_characteristic(surface) / 4; }

HandleRemoval::HandleRemoval(const Octree& octree, const std::vector<std::uint8_t>& open, const std::vector<std::uint8_t>& inside,
                             const DualSurface& surface, InsideTest centre_inside, const std::atomic<bool>* cancel)
    : octree_(octree), centre_inside_(std::move(centre_inside)), cancel_(cancel), handles_(count_handles(surface)) {
  std::vector<std::uint8_t> leaves(octree.leaf_count(), 0);
  for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf) {
    for (const std::uint32_t c : octree.corners(leaf)) leaves[leaf] |= open[c];
  }
  std::vector<std::uint8_t> around(leaves.size(), 0);
  for (const MinimalEdge& e : edges_around(octree, leaves, cancel)) {
    if (open[e.low] == 0 && open[e.high] == 0) continue;
    for (const std::uint32_t leaf : e.leaf) around[leaf] = 1;
  }
  edges_ = edges_around(octree, around, cancel);
  surface_ = sheets_in(octree, edges_, around, inside, centre_inside_);
  // The rest of the surface never changes.
  DisjointSets rest(surface.crossings.size());
  join_crossings(
      surface, [&](std::uint32_t leaf) { return around[leaf] == 0; }, [](std::uint32_t k) { return k; }, rest);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> known;
  std::vector<std::uint32_t> number(surface.crossings.size(), kNone);
  for (std::size_t p = 0; p < surface.patch_count(); ++p) {
    if (around[surface.patch_leaf[p]] != 0) continue;
    for (std::size_t k = surface.patch_begin[p]; k < surface.patch_begin[p + 1]; ++k) {
      const std::uint32_t crossing = surface.patch_crossings[k];
      std::uint32_t& n = number[rest.find(crossing)];
      if (n == kNone) n = static_cast<std::uint32_t>(parts_++);
      known.emplace_back(key(surface.crossings[crossing]), n);
    }
  }
  std::sort(known.begin(), known.end());
  for (const Crossing& c : surface_.crossings) {
    const auto found = std::lower_bound(known.begin(), known.end(), std::pair{key(c), std::uint32_t{0}});
    part_.push_back(found != known.end() && found->first == key(c) ? found->second : kNone);
  }
}

bool HandleRemoval::propose(const std::vector<std::uint8_t>& proposal, std::vector<std::uint8_t>& inside) {
  const Groups groups = group_corners(octree_, edges_, inside, proposal);
  if (groups.size.empty()) return false;
  const DualSurface here = sheets_in(octree_, edges_, groups.leaves, inside, centre_inside_);
  const Surroundings surroundings(surface_, part_, parts_, groups);
  std::vector<long> gain(groups.size.size(), 0);  // twice the change of the Euler characteristic: 4 for a handle less or a component more
  add_characteristic(here, groups, -1, gain);
  const std::vector<std::size_t> before = surroundings.components_with(here);
  std::vector<std::uint8_t> take(groups.size.size(), 1);
  std::vector<std::uint8_t> next = proposal;
  for (int round = 0; round < kRounds; ++round) {
    if (cancel_ != nullptr && cancel_->load()) throw Cancelled();
    const DualSurface result = sheets_in(octree_, edges_, groups.leaves, next, centre_inside_);
    if (round == 0) add_characteristic(result, groups, 1, gain);
    const std::vector<std::size_t> after = surroundings.components_with(result);
    bool settled = true;
    for (std::size_t g = 0; g < take.size(); ++g) {
      if (take[g] == 0) continue;
      const long handles = gain[g] / 4 - (static_cast<long>(after[g]) - static_cast<long>(before[g]));
      take[g] = handles > 0 && groups.size[g] <= kMostPerHandle * handles ? 1 : 0;
      settled = settled && take[g] != 0;
    }
    if (settled) {
      inside = std::move(next);
      const auto handles_here = [&] { return 4 * component_count(surface_, part_, parts_) - twice_characteristic(surface_); };
      const long four_times = handles_here();
      std::tie(surface_, part_) = surroundings.surface_with(result);
      handles_ += (handles_here() - four_times) / 4;
      return true;
    }
    if (std::find(take.begin(), take.end(), 1) == take.end()) return false;
    next = inside;
    for (std::size_t c = 0; c < next.size(); ++c) {
      if (groups.of_corner[c] != kNone && take[groups.of_corner[c]] != 0) next[c] = proposal[c];
    }
  }
  return false;
}

}  // namespace g3r::mesh
