#include "tree/traversal.h"

#include "cpu/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <unordered_map>

namespace g3r {
namespace {

constexpr int kMaxLevelDifference = 3;     // bounds the number of distinct offsets
constexpr std::size_t kTasksWanted = 512;  // target subtrees traversed in parallel; any value gives the same lists

std::vector<Vec3> centres_of(const Octree& tree) {
  std::vector<Vec3> centres(tree.nodes.size());
  parallel::for_all(centres.size(), [&](std::size_t i) { centres[i] = tree.nodes[i].centre(); });
  return centres;
}

}  // namespace

Traversal::Traversal(const Octree& targets, const Octree& sources, double opening, double reach)
    : targets_(targets),
      sources_(sources),
      opening_(opening),
      reach_(reach),
      target_centres_(centres_of(targets)),
      source_centres_(centres_of(sources)) {}

std::vector<std::vector<NodePair>> Traversal::start(FoundPairs& found) const {
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

void Traversal::run(std::vector<NodePair> open_pairs, FoundPairs& found) const {
  while (!open_pairs.empty()) {
    const NodePair pair = open_pairs.back();
    open_pairs.pop_back();
    open(pair, found, open_pairs);
  }
}

// Decides a pair, or replaces it by smaller pairs. Returns whether it was replaced.
bool Traversal::open(const NodePair& pair, FoundPairs& found, std::vector<NodePair>& out) const {
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

bool Traversal::far(const NodePair& pair, const OctreeNode& t, const OctreeNode& s) const {
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

}  // namespace g3r
