#include "mesh/handle_removal.h"

#include <algorithm>
#include <limits>

#include "mesh/disjoint_sets.h"

namespace g3r::mesh {
namespace {

constexpr long kMostPerHandle = 60;  // corners: more are a change of shape, not of a doubtful spot
constexpr int kRounds = 4;           // groups change what others do; what has not settled by then is left as it is
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Groups of corners that share leaves.
struct Groups {
  std::vector<std::uint32_t> of_corner, of_leaf;  // group or kNone
  std::vector<long> size;                         // corners of each
};

Groups group_corners(const Octree& octree, const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  Groups g;
  g.of_corner.assign(a.size(), kNone);
  g.of_leaf.assign(octree.leaf_count(), kNone);
  DisjointSets sets(a.size());
  const auto differs = [&](std::uint32_t c) { return a[c] != b[c]; };
  for (std::size_t leaf = 0; leaf < octree.leaf_count(); ++leaf) {
    std::uint32_t first = kNone;
    for (const std::uint32_t c : octree.corners(leaf)) {
      if (!differs(c)) continue;
      if (first == kNone) first = c;
      sets.join(first, c);
    }
    g.of_leaf[leaf] = first;
  }
  std::vector<std::uint32_t> number(a.size(), kNone);
  for (std::uint32_t c = 0; c < a.size(); ++c) {
    if (!differs(c)) continue;
    std::uint32_t& n = number[sets.find(c)];
    if (n == kNone) {
      n = static_cast<std::uint32_t>(g.size.size());
      g.size.push_back(0);
    }
    g.of_corner[c] = n;
    ++g.size[n];
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

// Of the sheets 0, 1, ... and, after them, the crossings.
DisjointSets components(const DualSurface& s) {
  DisjointSets sets(s.patch_count() + s.crossings.size());
  for (std::size_t p = 0; p < s.patch_count(); ++p) {
    for (std::size_t k = s.patch_begin[p]; k < s.patch_begin[p + 1]; ++k) sets.join(p, s.patch_count() + s.patch_crossings[k]);
  }
  return sets;
}

// How many components of the surface pass through the leaves of each group.
std::vector<std::size_t> components_near(const DualSurface& s, const Groups& groups) {
  DisjointSets sets = components(s);
  std::vector<std::pair<std::uint32_t, std::size_t>> seen;
  for (std::size_t p = 0; p < s.patch_count(); ++p) {
    const std::uint32_t g = groups.of_leaf[s.patch_leaf[p]];
    if (g != kNone) seen.emplace_back(g, sets.find(p));
  }
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  std::vector<std::size_t> count(groups.size.size(), 0);
  for (const auto& [g, component] : seen) ++count[g];
  return count;
}

}  // namespace

long count_handles(const DualSurface& surface) {
  // Vertices - edges + faces; every arc is on the rims of two sheets.
  const auto vertices = static_cast<long>(surface.patch_count()), faces = static_cast<long>(surface.crossings.size());
  const long euler = vertices - static_cast<long>(surface.patch_crossings.size()) / 2 + faces;
  return static_cast<long>(components(surface).count()) - euler / 2;
}

void remove_handles(const Octree& octree, const std::vector<std::uint8_t>& proposal, const InsideTest& centre_inside,
                    std::vector<std::uint8_t>& inside, DualSurface& surface, const std::atomic<bool>* cancel) {
  const Groups groups = group_corners(octree, inside, proposal);
  if (groups.size.empty()) return;
  std::vector<long> gain(groups.size.size(), 0);  // twice the change of the Euler characteristic: 4 for a handle less or a component more
  add_characteristic(surface, groups, -1, gain);
  const std::vector<std::size_t> before = components_near(surface, groups);
  std::vector<std::uint8_t> take(groups.size.size(), 1);
  std::vector<std::uint8_t> next = proposal;
  for (int round = 0; round < kRounds; ++round) {
    DualSurface result = contour(octree, next, centre_inside, cancel);
    if (round == 0) add_characteristic(result, groups, 1, gain);
    const std::vector<std::size_t> after = components_near(result, groups);
    bool settled = true;
    for (std::size_t g = 0; g < take.size(); ++g) {
      if (take[g] == 0) continue;
      const long handles = gain[g] / 4 - (static_cast<long>(after[g]) - static_cast<long>(before[g]));
      take[g] = handles > 0 && groups.size[g] <= kMostPerHandle * handles ? 1 : 0;
      settled = settled && take[g] != 0;
    }
    if (settled) {
      inside = std::move(next);
      surface = std::move(result);
      return;
    }
    if (std::find(take.begin(), take.end(), 1) == take.end()) return;
    next = inside;
    for (std::size_t c = 0; c < next.size(); ++c) {
      if (groups.of_corner[c] != kNone && take[groups.of_corner[c]] != 0) next[c] = proposal[c];
    }
  }
}

}  // namespace g3r::mesh
