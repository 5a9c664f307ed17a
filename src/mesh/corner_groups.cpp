#include "mesh/corner_groups.h"

#include "base/disjoint_sets.h"
#include "base/hash.h"
#include "mesh/constants.h"

#include <algorithm>

namespace g3r::mesh {
CornerGrouping::CornerGrouping(const OpenEdges& open) : open_(open), group_(open.around.count(), kNone), changed_(open.around.count(), 0) {}

CornerGroups CornerGrouping::group(const std::vector<std::uint8_t>& proposal, const std::vector<std::uint8_t>& inside,
                                   const std::function<bool(long)>& may_be) {
  CornerGroups g;
  for (std::uint32_t i = 0; i < open_.corners.size(); ++i) {
    if (proposal[open_.corners[i]] != inside[open_.corners[i]]) g.place.push_back(i);
  }
  DisjointSets sets(g.place.size());
  for (std::uint32_t k = 0; k < g.place.size(); ++k) {
    for (const std::uint32_t edge : open_.at_corner.of(g.place[k])) {
      for (const std::uint32_t of_octree : open_.edges[edge].leaf) {
        const std::uint32_t leaf = open_.around.number(of_octree);
        if (group_[leaf] == k) continue;
        if (group_[leaf] == kNone) {
          g.leaves.push_back(leaf);
        } else {
          sets.join(group_[leaf], k);
        }
        group_[leaf] = k;
      }
    }
  }
  for (std::uint32_t k = 0; k < g.place.size(); ++k) {
    const std::size_t first = sets.find(k);  // the smallest, so its group has a number
    if (first == k) g.size.push_back(0), g.name.push_back(0);
    g.of.push_back(first == k ? static_cast<std::uint32_t>(g.size.size() - 1) : g.of[first]);
    ++g.size[g.of[k]];
    g.name[g.of[k]] += mixed(open_.corners[g.place[k]]);
  }
  std::vector<std::uint32_t> change(g.count(), 0);
  for (const std::uint32_t leaf : g.leaves) {
    group_[leaf] = g.of[group_[leaf]];
    change[group_[leaf]] = std::max(change[group_[leaf]], changed_[leaf]);
  }
  for (std::size_t i = 0; i < change.size(); ++i) g.name[i] = mixed(g.name[i] + change[i]);
  drop(g, may_be);
  return g;
}

void CornerGrouping::drop(CornerGroups& g, const std::function<bool(long)>& may_be) {
  std::vector<std::uint32_t> number(g.count(), kNone);
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (!may_be(g.size[i]) || refused_.contains(g.name[i])) continue;
    number[i] = kept;
    g.size[kept] = g.size[i];
    g.name[kept++] = g.name[i];
  }
  g.size.resize(kept);
  g.name.resize(kept);
  std::size_t corners = 0;
  for (std::size_t k = 0; k < g.of.size(); ++k) {
    if (number[g.of[k]] == kNone) continue;
    g.place[corners] = g.place[k];
    g.of[corners++] = number[g.of[k]];
  }
  g.place.resize(corners);
  g.of.resize(corners);
  std::erase_if(g.leaves, [&](std::uint32_t leaf) { return (group_[leaf] = number[group_[leaf]]) == kNone; });
}

void CornerGrouping::end(const CornerGroups& groups, const std::vector<std::uint8_t>& take) {
  for (std::size_t g = 0; g < take.size(); ++g) {
    if (take[g] == 0) refused_.insert(groups.name[g]);
  }
  if (std::find(take.begin(), take.end(), 1) != take.end()) ++changes_;
  for (const std::uint32_t leaf : groups.leaves) {
    if (take[group_[leaf]] != 0) changed_[leaf] = changes_;
    group_[leaf] = kNone;
  }
}

}  // namespace g3r::mesh
