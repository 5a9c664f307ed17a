// Sums of weights between pairs of nodes, of a graph whose nodes become fewer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A number for each of some pairs of different nodes: a hash table with linear probing (Knuth, The Art of Computer Programming 3, 6.4),
/// half full at most: 32 bytes a pair. All is O(1) but for_each().
class PairSums {
 public:
  /// For that many pairs at a time.
  explicit PairSums(std::size_t most_pairs) : slots_(2 * most_pairs + 2) {}

  /// The number of the pair, null if it has none; valid until a pair is added or removed. A pair may be given either way round.
  [[nodiscard]] double* find(std::uint32_t a, std::uint32_t b) {
    Slot& slot = slots_[place(key_of(a, b))];
    return slot.key == kFree ? nullptr : &slot.sum;
  }

  /// Adds a pair that is not there yet.
  void add(std::uint32_t a, std::uint32_t b, double sum) {
    const std::uint64_t key = key_of(a, b);
    slots_[place(key)] = {key, sum};
  }

  /// Removes a pair that is there.
  void remove(std::uint32_t a, std::uint32_t b) {
    // Those behind it that stand where they do because it was in their way come closer.
    std::size_t hole = place(key_of(a, b));
    for (std::size_t at = next(hole); slots_[at].key != kFree; at = next(at)) {
      const std::size_t wanted = first_place(slots_[at].key);
      if (distance(wanted, at) >= distance(hole, at)) {
        slots_[hole] = slots_[at];
        hole = at;
      }
    }
    slots_[hole].key = kFree;
  }

  /// body(a, b, sum) for every pair, a < b, in no order.
  template <class Body>
  void for_each(const Body& body) const {
    for (const Slot& slot : slots_) {
      if (slot.key != kFree) body(static_cast<std::uint32_t>(slot.key >> 32U), static_cast<std::uint32_t>(slot.key), slot.sum);
    }
  }

 private:
  static constexpr std::uint64_t kFree = 0;  // no pair has it: the second node is greater than the first
  struct Slot {
    std::uint64_t key = kFree;
    double sum = 0;
  };

  static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b); }
  [[nodiscard]] std::size_t next(std::size_t at) const { return at + 1 < slots_.size() ? at + 1 : 0; }
  // Slots from one to another, on from the last to the first.
  [[nodiscard]] std::size_t distance(std::size_t from, std::size_t to) const { return to >= from ? to - from : to + slots_.size() - from; }
  [[nodiscard]] std::size_t first_place(std::uint64_t key) const {
    constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15U;  // 2^64 over the golden ratio: neighbours are scattered
    return static_cast<std::size_t>((((key * kGolden) >> 32U) * slots_.size()) >> 32U);
  }
  // Where the pair is, or is to be put.
  [[nodiscard]] std::size_t place(std::uint64_t key) const {
    std::size_t at = first_place(key);
    while (slots_[at].key != key && slots_[at].key != kFree) at = next(at);
    return at;
  }

  std::vector<Slot> slots_;
};

}  // namespace g3r
