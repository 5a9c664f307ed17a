#include "tree/interaction_lists.h"

#include "base/platform.h"
#include "cpu/parallel.h"
#include "tree/far_pairs.h"
#include "tree/traversal.h"

#include <algorithm>
#include <utility>

namespace g3r {
namespace {

constexpr std::size_t kManyTargets = 1 << 17;  // whose pairs are found in blocks of tens of MB; fewer leave less than the time is worth
constexpr std::size_t kLeavesOfABlock = 64;    // whose lists are sorted in one go; any value gives the same lists
constexpr std::uint32_t kNotALeaf = 0xffffffffu;

// By task, and at last those that were found before there were tasks.
std::vector<FoundPairs> find_pairs(const Octree& targets, const Octree& sources, double opening, double reach) {
  const Traversal traversal(targets, sources, opening, reach);
  FoundPairs top;
  std::vector<std::vector<NodePair>> tasks = traversal.start(top);
  std::vector<FoundPairs> found(tasks.size() + 1);
  found.back() = std::move(top);
  parallel::for_each(tasks.size(), [&](std::size_t i) { traversal.run(std::move(tasks[i]), found[i]); });
  return found;
}

// Of every node its index into the tree's leaves.
std::vector<std::uint32_t> leaf_numbers(const Octree& tree) {
  std::vector<std::uint32_t> number(tree.nodes.size(), kNotALeaf);
  for (std::uint32_t i = 0; i < tree.leaves.size(); ++i) number[tree.leaves[i]] = i;
  return number;
}

// Puts far pairs into the parts of their targets, and near ones into the lists of their target leaves; gives their memory back.
void place_pairs(const Octree& targets, const Octree& sources, std::vector<FoundPairs>& found, InteractionLists& lists) {
  const std::vector<std::uint32_t>& part_of = lists.parts.part_of;
  const std::vector<std::uint32_t> target_leaf = leaf_numbers(targets);
  const std::vector<std::uint32_t> source_leaf = leaf_numbers(sources);
  lists.far_begin.assign(lists.parts.size() + 1, 0);
  lists.near_begin.assign(targets.leaves.size() + 1, 0);
  // Of what each task has found, where its pairs of every part of the tree begin; the near pairs of a leaf are all of one task, or of the
  // last.
  std::vector<std::vector<std::size_t>> next_far(found.size(), std::vector<std::size_t>(lists.parts.size(), 0));
  const auto for_all = [&](const auto& work) {
    parallel::for_each(found.size() - 1, work);
    work(found.size() - 1);
  };
  for_all([&](std::size_t i) {
    for (const NodePair& pair : found[i].far) ++next_far[i][part_of[pair.target]];
    for (const NodePair& pair : found[i].near) ++lists.near_begin[target_leaf[pair.target] + 1];
  });
  std::size_t far_pairs = 0;
  for (std::size_t c = 0; c < lists.parts.size(); ++c) {
    for (std::vector<std::size_t>& next : next_far) far_pairs += std::exchange(next[c], far_pairs);
    lists.far_begin[c + 1] = far_pairs;
  }
  for (std::size_t i = 0; i < targets.leaves.size(); ++i) lists.near_begin[i + 1] += lists.near_begin[i];
  lists.far.resize(lists.far_begin.back());
  lists.near.resize(lists.near_begin.back());
  std::vector<std::size_t> next_near(lists.near_begin.begin(), lists.near_begin.end() - 1);
  for_all([&](std::size_t i) {
    for (const NodePair& pair : found[i].far) lists.far[next_far[i][part_of[pair.target]]++] = {pair.target, pair.source};
    for (const NodePair& pair : found[i].near) lists.near[next_near[target_leaf[pair.target]]++] = source_leaf[pair.source];
    found[i] = {};
  });
}

void sort_near(InteractionLists& lists) {
  parallel::for_blocks(lists.near_begin.size() - 1, kLeavesOfABlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::sort(lists.near.begin() + static_cast<std::ptrdiff_t>(lists.near_begin[i]),
                lists.near.begin() + static_cast<std::ptrdiff_t>(lists.near_begin[i + 1]));
    }
  });
}

}  // namespace

InteractionLists build_interaction_lists(const Octree& targets, const Octree& sources, double opening, double reach) {
  std::vector<FoundPairs> found = find_pairs(targets, sources, opening, reach);
  InteractionLists lists;
  lists.parts = cut_tree(targets, points_of_a_part(targets.nodes.front().count()));
  place_pairs(targets, sources, found, lists);
  sort_near(lists);
  sort_far_pairs(targets, sources, lists);
  if (targets.nodes.front().count() > kManyTargets) platform::give_back_holes();  // of what subtrees have found
  return lists;
}

}  // namespace g3r
