// Source: the dual tree traversal of Dehnen 2002 with a symmetric splitting rule.
#include "tree/interaction_lists.h"

#include "base/platform.h"
#include "cpu/parallel.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>

namespace g3r {
namespace {

constexpr int kMaxLevelDifference = 3;         // bounds the number of distinct offsets
constexpr std::size_t kTasksWanted = 512;      // target subtrees traversed in parallel; any value gives the same lists
constexpr std::size_t kManyTargets = 1 << 17;  // whose pairs are found in blocks of tens of MB; fewer leave less than the time is worth
constexpr std::uint32_t kNotALeaf = 0xffffffffu;

struct NodePair {
  std::uint32_t target;
  std::uint32_t source;
};

// The pairs that one target subtree produced.
struct Found {
  std::vector<NodePair> far;
  std::vector<NodePair> near;
};

class Traversal {
 public:
  Traversal(const Octree& targets, const Octree& sources, double opening, double reach)
      : targets_(targets), sources_(sources), opening_(opening), reach_(reach) {
    find_centres(targets, target_centres_);
    find_centres(sources, source_centres_);
  }

  // Breadth first until the target side has enough subtrees; returns the open pairs grouped by target subtree.
  std::vector<std::vector<NodePair>> start(Found& found) const {
    std::vector<std::vector<NodePair>> tasks{{{0, 0}}};
    for (bool progress = true; progress && tasks.size() < kTasksWanted;) {
      progress = false;
      std::vector<std::vector<NodePair>> next;
      std::unordered_map<std::uint32_t, std::size_t> task_of;
      for (const auto& task : tasks) {
        std::vector<NodePair> stack = task;
        while (!stack.empty()) {
          const NodePair pair = stack.back();
          stack.pop_back();
          std::vector<NodePair> opened;
          if (!open(pair, found, opened)) continue;
          progress = true;
          for (const NodePair& child : opened) {
            if (child.target == pair.target) {
              stack.push_back(child);
              continue;
            }
            const auto [where, fresh] = task_of.try_emplace(child.target, next.size());
            if (fresh) next.emplace_back();
            next[where->second].push_back(child);
          }
        }
      }
      tasks.swap(next);
    }
    return tasks;
  }

  void run(std::vector<NodePair> stack, Found& found) const {
    while (!stack.empty()) {
      const NodePair pair = stack.back();
      stack.pop_back();
      open(pair, found, stack);
    }
  }

 private:
  static void find_centres(const Octree& tree, std::vector<Vec3>& centres) {
    centres.resize(tree.nodes.size());
    parallel::for_all(centres.size(), [&](std::size_t i) { centres[i] = tree.nodes[i].centre(); });
  }

  // Decides a pair, or replaces it by smaller pairs. Returns whether it was replaced.
  bool open(const NodePair& pair, Found& found, std::vector<NodePair>& out) const {
    const OctreeNode& t = targets_.nodes[pair.target];
    const OctreeNode& s = sources_.nodes[pair.source];
    if (far(pair, t, s)) {
      found.far.push_back(pair);
      return false;
    }
    if (t.leaf() && s.leaf()) {
      found.near.push_back(pair);
      return false;
    }
    // The lower level (larger cube) is split, both when equal: a symmetric rule.
    const bool split_target = !t.leaf() && (s.leaf() || t.level <= s.level);
    const bool split_source = !s.leaf() && (t.leaf() || s.level <= t.level);
    const std::uint32_t t_first = split_target ? t.first_child : pair.target;
    const std::uint32_t t_count = split_target ? t.child_count : 1;
    const std::uint32_t s_first = split_source ? s.first_child : pair.source;
    const std::uint32_t s_count = split_source ? s.child_count : 1;
    for (std::uint32_t i = 0; i < t_count; ++i) {
      for (std::uint32_t j = 0; j < s_count; ++j) out.push_back({t_first + i, s_first + j});
    }
    return true;
  }

  [[nodiscard]] bool far(const NodePair& pair, const OctreeNode& t, const OctreeNode& s) const {
    if (opening_ <= 0 || std::abs(t.level - s.level) > kMaxLevelDifference) return false;
    const Vec3& a = target_centres_[pair.target];
    const Vec3& b = source_centres_[pair.source];
    const double dx = a[0] - b[0];
    const double dy = a[1] - b[1];
    const double dz = a[2] - b[2];
    const double squared = dx * dx + dy * dy + dz * dz;
    const double radii = t.radius + s.radius;
    if (radii * radii > opening_ * opening_ * squared) return false;
    const double gap = radii + reach_ * std::max(t.width, s.width);
    return gap * gap <= squared;
  }

  const Octree& targets_;
  const Octree& sources_;
  double opening_;
  double reach_;
  std::vector<Vec3> target_centres_;
  std::vector<Vec3> source_centres_;
};

Offset offset_of(const OctreeNode& t, const OctreeNode& s) {
  Offset offset;
  offset.level_difference = s.level - t.level;
  const int finest = std::max(t.level, s.level);
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t target = static_cast<std::int64_t>(2 * t.cell[a] + 1) << (finest - t.level);
    const std::int64_t source = static_cast<std::int64_t>(2 * s.cell[a] + 1) << (finest - s.level);
    offset.displacement[a] = static_cast<std::int32_t>(target - source);
  }
  return offset;
}

// Numbers distinct offsets in order of appearance. Open addressing: one probe and one comparison for most of millions of pairs.
class OffsetNumbers {
 public:
  std::uint32_t number(const Offset& offset) {
    if (2 * offsets_.size() >= slots_.size()) grow();
    std::uint32_t& slot = find(offset);
    if (slot == kFree) {
      slot = static_cast<std::uint32_t>(offsets_.size());
      offsets_.push_back(offset);
    }
    return slot;
  }
  [[nodiscard]] const std::vector<Offset>& offsets() const { return offsets_; }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;
  static constexpr std::size_t kFirstSlots = 1024;

  std::uint32_t& find(const Offset& o) {
    std::uint64_t hash = static_cast<std::uint32_t>(o.level_difference);
    for (const std::int32_t d : o.displacement) hash = (hash ^ static_cast<std::uint32_t>(d)) * 0x9e3779b97f4a7c15ULL;
    std::size_t at = (hash ^ hash >> 29) & (slots_.size() - 1);
    while (slots_[at] != kFree && offsets_[slots_[at]] != o) at = (at + 1) & (slots_.size() - 1);
    return slots_[at];
  }
  void grow() {
    slots_.assign(slots_.empty() ? kFirstSlots : 2 * slots_.size(), kFree);
    for (std::uint32_t i = 0; i < offsets_.size(); ++i) find(offsets_[i]) = i;
  }

  std::vector<Offset> offsets_;
  std::vector<std::uint32_t> slots_;  // a power of two of them
};

// Copies `in` to `out` in ascending order of key(element) < keys, equal ones in their order. O(in + keys).
template <class T, class Key>
void counting_sort(std::span<const T> in, std::span<T> out, std::size_t keys, const Key& key) {
  std::vector<std::uint32_t> next(keys + 1, 0);
  for (const T& element : in) ++next[key(element) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (const T& element : in) out[next[key(element)]++] = element;
}

// Sorts the far pairs of a part by offset, target, source; an offset and a target have one source. `pairs`: with offsets by their number in
// the part, which is `global[number]` among all. Returns the runs.
std::vector<FarRun> sort_part(const std::vector<NumberedPair>& pairs, const std::vector<std::uint32_t>& global,
                              const std::vector<std::uint32_t>& slot, std::span<FarPair> sorted) {
  std::vector<FarRun> runs;
  if (pairs.empty()) return runs;
  std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t last = 0;
  for (const NumberedPair& p : pairs) {
    first = std::min(first, slot[p.pair.target]);
    last = std::max(last, slot[p.pair.target]);
  }
  std::vector<NumberedPair> by_target(pairs.size());
  counting_sort<NumberedPair>(pairs, by_target, last - first + 1, [&](const NumberedPair& p) { return slot[p.pair.target] - first; });
  std::vector<std::uint32_t> rank(global.size());
  std::vector<std::uint32_t> order(global.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) { return global[i] < global[j]; });
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
  std::vector<NumberedPair> by_offset(pairs.size());
  counting_sort<NumberedPair>(by_target, by_offset, global.size(), [&](const NumberedPair& p) { return rank[p.offset]; });
  for (std::size_t i = 0; i < by_offset.size(); ++i) {
    const std::uint32_t offset = global[by_offset[i].offset];
    sorted[i] = by_offset[i].pair;
    if (runs.empty() || runs.back().offset != offset) runs.push_back({offset, 0});
    ++runs.back().pairs;
  }
  return runs;
}

// Finds the distinct offsets and puts the far pairs, so far in no order within a part, into theirs.
void sort_far_pairs(const Octree& targets, const Octree& sources, InteractionLists& lists) {
  const std::size_t parts = lists.parts.size();
  std::vector<OffsetNumbers> found(parts);
  std::vector<std::vector<std::uint32_t>> number(parts);  // of the offset of each far pair
  parallel::for_each(parts, [&](std::size_t c) {
    number[c].reserve(lists.far_begin[c + 1] - lists.far_begin[c]);
    for (std::size_t i = lists.far_begin[c]; i < lists.far_begin[c + 1]; ++i) {
      const FarPair& pair = lists.far[i];
      number[c].push_back(found[c].number(offset_of(targets.nodes[pair.target], sources.nodes[pair.source])));
    }
  });
  for (const OffsetNumbers& part : found) lists.offsets.insert(lists.offsets.end(), part.offsets().begin(), part.offsets().end());
  parallel::sort(lists.offsets.begin(), lists.offsets.end(), std::less<>());
  lists.offsets.erase(std::unique(lists.offsets.begin(), lists.offsets.end()), lists.offsets.end());
  std::vector<std::vector<FarRun>> runs(parts);
  parallel::for_each(parts, [&](std::size_t c) {
    const std::vector<Offset>& local = found[c].offsets();
    std::vector<std::uint32_t> global(local.size());
    for (std::size_t k = 0; k < global.size(); ++k) {
      global[k] =
          static_cast<std::uint32_t>(std::lower_bound(lists.offsets.begin(), lists.offsets.end(), local[k]) - lists.offsets.begin());
    }
    const std::span<FarPair> pairs(lists.far.data() + lists.far_begin[c], number[c].size());
    std::vector<NumberedPair> numbered(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) numbered[i] = {pairs[i], number[c][i]};
    std::vector<std::uint32_t>().swap(number[c]);
    runs[c] = sort_part(numbered, global, lists.parts.slot, pairs);
  });
  lists.run_begin.assign(1, 0);
  for (const std::vector<FarRun>& part : runs) lists.run_begin.push_back(lists.run_begin.back() + part.size());
  lists.runs.reserve(lists.run_begin.back());
  for (const std::vector<FarRun>& part : runs) lists.runs.insert(lists.runs.end(), part.begin(), part.end());
}

}  // namespace

InteractionLists build_interaction_lists(const Octree& targets, const Octree& sources, double opening, double reach) {
  const Traversal traversal(targets, sources, opening, reach);
  Found top;
  std::vector<std::vector<NodePair>> tasks = traversal.start(top);
  std::vector<Found> found(tasks.size() + 1);
  found.back() = std::move(top);
  parallel::for_each(tasks.size(), [&](std::size_t i) { traversal.run(std::move(tasks[i]), found[i]); });

  InteractionLists lists;
  lists.parts = cut_tree(targets, points_of_a_part(targets.nodes.front().count()));
  const std::vector<std::uint32_t>& part_of = lists.parts.part_of;
  lists.far_begin.assign(lists.parts.size() + 1, 0);
  std::vector<std::uint32_t> target_leaf(targets.nodes.size(), kNotALeaf);
  std::vector<std::uint32_t> source_leaf(sources.nodes.size(), kNotALeaf);
  for (std::uint32_t i = 0; i < targets.leaves.size(); ++i) target_leaf[targets.leaves[i]] = i;
  for (std::uint32_t i = 0; i < sources.leaves.size(); ++i) source_leaf[sources.leaves[i]] = i;
  lists.near_begin.assign(targets.leaves.size() + 1, 0);
  // Of what each task has found, where its pairs of every part of the tree begin; the near pairs of a leaf are all of one task, or of the
  // last, which is what was found before there were tasks.
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
  parallel::for_blocks(targets.leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::sort(lists.near.begin() + static_cast<std::ptrdiff_t>(lists.near_begin[i]),
                lists.near.begin() + static_cast<std::ptrdiff_t>(lists.near_begin[i + 1]));
    }
  });
  sort_far_pairs(targets, sources, lists);
  if (targets.nodes.front().count() > kManyTargets) platform::give_back_holes();  // of what subtrees have found
  return lists;
}

}  // namespace g3r
