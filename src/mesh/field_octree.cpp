#include "mesh/field_octree.h"

#include "base/hash.h"
#include "cpu/parallel.h"
#include "mesh/constants.h"

#include <g3r/error.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <new>

namespace g3r::mesh {
namespace {

// A corner coordinate is 0 to 2^kMaxOctreeLevel, the last included, and has so many bits.
constexpr int kKeyBits = kMaxOctreeLevel + 1;
// A node's number has 31 bits.
constexpr std::uint32_t kLargestNode = std::numeric_limits<std::int32_t>::max();
// The place of a corner on the lattices of all families has 32 bits, so that there are no more nodes.
constexpr std::uint32_t kMostNodes = std::numeric_limits<std::uint32_t>::max() / kLatticeSize * kOctants;

std::uint64_t corner_key(const std::array<std::uint32_t, 3>& c) {
  return (std::uint64_t{c[2]} << (2 * kKeyBits)) | (std::uint64_t{c[1]} << kKeyBits) | c[0];
}

// Throws Cancelled where it is asked for, which is looked at for one of so many cells.
void throw_if_cancelled(std::size_t cell, const std::atomic<bool>* cancel) {
  if (cell % parallel::kSmallBlock == 0 && cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
}

// Numbers keys in the order of their first use: open addressing with linear probing.
class CornerTable {
 public:
  explicit CornerTable(std::size_t expected) { resize(std::bit_ceil(2 * expected + 1)); }

  // `keys`: those numbered so far, in order; a new one is appended.
  std::uint32_t number(std::uint64_t key, std::vector<std::uint64_t>& keys) {
    std::size_t i = place(key);
    while (slot_[i] != kFree && keys[slot_[i]] != key) i = (i + 1) & (slot_.size() - 1);
    if (slot_[i] != kFree) return slot_[i];
    const auto added = static_cast<std::uint32_t>(keys.size());
    slot_[i] = added;
    keys.push_back(key);
    if (2 * keys.size() > slot_.size()) grow(keys);
    return added;
  }

 private:
  static constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();

  // Fibonacci hashing: the top bits of a product are well mixed.
  [[nodiscard]] std::size_t place(std::uint64_t key) const { return static_cast<std::size_t>((key * kGolden) >> shift_); }
  void resize(std::size_t size) {
    slot_.assign(size, kFree);
    shift_ = std::numeric_limits<std::uint64_t>::digits - std::countr_zero(size);
  }
  void grow(const std::vector<std::uint64_t>& keys) {
    resize(2 * slot_.size());
    for (std::uint32_t k = 0; k < keys.size(); ++k) {
      std::size_t i = place(keys[k]);
      while (slot_[i] != kFree) i = (i + 1) & (slot_.size() - 1);
      slot_[i] = k;
    }
  }

  std::vector<std::uint32_t> slot_;
  int shift_ = 0;
};

// Conservative: a box that touches the disc always passes, a few more near its rim do too.
bool touches(const RefineDisc& r, const Vec3& low, double side) {
  double squared = 0, along = 0, reach = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = std::max({low[a] - r.centre[a], 0.0, r.centre[a] - low[a] - side});
    squared += d * d;
    along += r.normal[a] * (low[a] + 0.5 * side - r.centre[a]);
    reach += std::abs(r.normal[a]);
  }
  return squared <= r.radius * r.radius && std::abs(along) <= 0.5 * side * reach + r.half_thickness;
}

}  // namespace

struct Octree::Frontier {
  std::vector<std::uint32_t> node;
  std::vector<std::size_t> begin;  // node.size() + 1 offsets into request
  std::vector<std::uint32_t> request;
};

Octree::Octree(const Vec3& low, double side, const std::vector<RefineDisc>& requests, int base_level, const std::atomic<bool>* cancel)
    : Octree(
          low, side, requests, [=](const OctreeNode& node) { return node.level < base_level ? Split::kYes : Split::kAsRequested; },
          cancel) {}

Octree::Octree(const Vec3& low, double side, const std::vector<RefineDisc>& requests, const SplitRule& rule,
               const std::atomic<bool>* cancel)
    : low_(low), unit_(side / static_cast<double>(std::uint32_t{1} << kMaxOctreeLevel)) {
  refine(requests, rule, cancel);
  nodes_.shrink_to_fit();
  families_.shrink_to_fit();
  leaf_nodes_.reserve(nodes_.size() - (nodes_.size() - 1) / kOctants);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    throw_if_cancelled(i, cancel);
    if (nodes_[i].split != 0) continue;
    nodes_[i].next = static_cast<std::uint32_t>(leaf_nodes_.size()) & kLargestNode;
    leaf_nodes_.push_back(static_cast<std::uint32_t>(i));
    depth_ = std::max(depth_, static_cast<int>(level_of(static_cast<std::uint32_t>(i))));
  }
  number_corners(cancel);
}

void Octree::refine(const std::vector<RefineDisc>& requests, const SplitRule& rule, const std::atomic<bool>* cancel) {
  nodes_.push_back({0, 0});
  families_.emplace_back();  // until the root is split
  Frontier front{{0}, {0, requests.size()}, {}};
  front.request.resize(requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) front.request[i] = static_cast<std::uint32_t>(i);
  for (int level = 0; level < kMaxOctreeLevel && !front.node.empty(); ++level) {
    const std::vector<std::size_t> split = split_nodes(front, level, requests, rule, cancel);
    front = children_of(front, split, level, requests, cancel);
  }
}

// Splits the nodes of the front, all of one level, that the rule or some request wants deeper. Returns their places in the front.
std::vector<std::size_t> Octree::split_nodes(const Frontier& front, int level, const std::vector<RefineDisc>& requests,
                                             const SplitRule& rule, const std::atomic<bool>* cancel) {
  std::vector<std::size_t> split;
  for (std::size_t f = 0; f < front.node.size(); ++f) {
    throw_if_cancelled(f, cancel);
    const Split split_it = rule(node(front.node[f]));
    bool deeper = split_it == Split::kYes;
    for (std::size_t k = front.begin[f]; split_it == Split::kAsRequested && !deeper && k < front.begin[f + 1]; ++k)
      deeper = requests[front.request[k]].level > level;
    if (!deeper) continue;
    if (nodes_.size() > kMostNodes - kOctants) throw std::bad_alloc();
    const std::uint32_t parent = front.node[f];
    const Family children{node(parent).low, static_cast<std::uint8_t>(level + 1)};
    nodes_[parent] = {static_cast<std::uint32_t>(nodes_.size()) & kLargestNode, 1};
    if (parent == 0) families_.clear();
    families_.push_back(children);
    nodes_.resize(nodes_.size() + kOctants, {0, 0});
    split.push_back(f);
  }
  return split;
}

// The children of the nodes of the front that have been split, each with the requests that touch it and want it deeper: counted, then
// filled in, so that the order does not depend on the threads.
Octree::Frontier Octree::children_of(const Frontier& front, const std::vector<std::size_t>& split, int level,
                                     const std::vector<RefineDisc>& requests, const std::atomic<bool>* cancel) const {
  Frontier next;
  const std::size_t children = split.size() * kOctants;
  next.node.resize(children);
  std::vector<std::vector<std::uint32_t>> lists(children);
  const auto hand_on = [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) {
      const std::uint32_t base = next_of(front.node[split[s]]);
      for (std::uint32_t c = 0; c < kOctants; ++c) {
        const OctreeNode child = node(base + c);
        const Vec3 low = world(child.low[0], child.low[1], child.low[2]);
        const double side = unit_ * extent(child);
        next.node[kOctants * s + c] = base + c;
        for (std::size_t k = front.begin[split[s]]; k < front.begin[split[s] + 1]; ++k) {
          const RefineDisc& r = requests[front.request[k]];
          if (r.level > level + 1 && touches(r, low, side)) lists[kOctants * s + c].push_back(front.request[k]);
        }
      }
    }
  };
  parallel::for_blocks(split.size(), parallel::kSmallBlock, hand_on, cancel);
  next.begin.assign(children + 1, 0);
  for (std::size_t c = 0; c < children; ++c) next.begin[c + 1] = next.begin[c] + lists[c].size();
  next.request.resize(next.begin[children]);
  for (std::size_t c = 0; c < children; ++c) {
    throw_if_cancelled(c, cancel);
    std::copy(lists[c].begin(), lists[c].end(), next.request.begin() + static_cast<std::ptrdiff_t>(next.begin[c]));
  }
  return next;
}

void Octree::number_corners(const std::atomic<bool>* cancel) {
  family_corners_.resize(family(static_cast<std::uint32_t>(nodes_.size() - 1)) + 1);
  std::vector<std::uint64_t> keys;
  CornerTable table(leaf_nodes_.size());  // grows where there are more
  for (std::size_t number = 0; number < leaf_nodes_.size(); ++number) {
    throw_if_cancelled(number, cancel);
    const std::uint32_t leaf = leaf_nodes_[number];
    const OctreeNode own = node(leaf);
    for (std::uint32_t c = 0; c < kOctants; ++c) {
      std::array<std::uint32_t, 3> g{};
      for (std::size_t a = 0; a < 3; ++a) g[a] = own.low[a] + ((c >> a) & 1U) * extent(own);
      const std::uint32_t place = kLatticePlace[sibling(leaf)] + kLatticePlace[c];
      const std::uint32_t corner = table.number(corner_key(g), keys);
      family_corners_[family(leaf)][place] = corner;
      if (corner == corner_places_.size()) corner_places_.push_back(static_cast<std::uint32_t>(family(leaf) * kLatticeSize + place));
    }
  }
  corner_places_.shrink_to_fit();
}

std::array<std::uint32_t, 3> Octree::corner_grid(std::size_t corner) const {
  const Family& own = families_[corner_places_[corner] / kLatticeSize];
  const std::uint32_t place = corner_places_[corner] % kLatticeSize, step = std::uint32_t{1} << (kMaxOctreeLevel - own.level);
  return {own.low[0] + place % kLatticeSide * step, own.low[1] + place / kLatticeSide % kLatticeSide * step,
          own.low[2] + place / (kLatticeSide * kLatticeSide) * step};
}

bool Octree::on_boundary(std::size_t corner) const {
  const auto g = corner_grid(corner);
  const std::uint32_t top = std::uint32_t{1} << kMaxOctreeLevel;
  return g[0] == 0 || g[1] == 0 || g[2] == 0 || g[0] == top || g[1] == top || g[2] == top;
}

Vec3 Octree::corner_position(std::size_t corner) const {
  const auto g = corner_grid(corner);
  return world(g[0], g[1], g[2]);
}

}  // namespace g3r::mesh
