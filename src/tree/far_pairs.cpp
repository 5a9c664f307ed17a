#include "tree/far_pairs.h"

#include "cpu/parallel.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace g3r {
namespace {

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

}  // namespace

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

}  // namespace g3r
