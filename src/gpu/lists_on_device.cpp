#include "gpu/lists_on_device.h"

#include "cpu/parallel.h"
#include "cpu/parallel_sort.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace g3r::gpu {
namespace {

constexpr int kFinest = 21;               // level of the grid; centres are multiples of 2^-21
constexpr std::size_t kMatrixBatch = 64;  // M2L matrices made at a time where the processor does not keep them
constexpr std::size_t kMirrors = 8;
// Target nodes whose M2L a work-group does. Pairs of more nodes share more matrices, but a GPU stands still while it has fewer groups than
// it can run at a time: an H200 runs 4,224. Measured there, between 1 and 32: at 50,000 points 1 was best, at 1,000,000 it was 4.
// Processors run few groups at a time.
constexpr std::size_t kGroupsWanted = 8192;
constexpr std::size_t kMostChunkNodes = 4;
constexpr std::size_t kSoftwareChunkNodes = 32;
// Parts that targets are cut into at most: their locals, a third of what a sum takes, become an eighth of that, and more save next to
// nothing.
constexpr std::size_t kMostParts = 8;
constexpr std::size_t kChunkBlock = 64;  // chunks that a thread tiles at a time: some thousand pairs

std::size_t chunk_nodes_for(std::size_t nodes, bool software) {
  return software ? kSoftwareChunkNodes : std::clamp(nodes / kGroupsWanted, std::size_t{1}, kMostChunkNodes);
}

using Int4 = std::array<std::int32_t, 4>;
using Uint2 = std::array<std::uint32_t, 2>;
using Uint4 = std::array<std::uint32_t, 4>;

Int4 centre(const OctreeNode& node) {
  Int4 out{0, 0, 0, node.level};
  for (std::size_t a = 0; a < 3; ++a) out[a] = (2 * node.cell[a] + 1) * (1 << (kFinest - node.level)) - (1 << kFinest);
  return out;
}

// Groups and data of a matrix at the end of what is there; `offset` in units of kLanes, moves on.
template <class T>
std::size_t add_groups(const cpu::TranslationMatrix<T>& matrix, std::size_t& offset, std::vector<Uint4>& groups) {
  std::size_t elements = 0;
  for (std::size_t g = 0; g < matrix.groups; ++g) {
    groups.push_back({narrow(offset), matrix.columns[g].first, matrix.columns[g].last, 0});
    const std::size_t columns = matrix.columns[g].last - matrix.columns[g].first;
    offset += columns;
    elements += columns * cpu::kLanes;
  }
  return elements;
}

template <class T>
MatricesOnDevice upload_shifts(Device& device, const std::array<StoredTranslation<T>, 8>& shifts, std::size_t coefficients) {
  std::vector<Uint4> groups;
  std::vector<T> data;
  std::size_t offset = 0;
  for (const StoredTranslation<T>& shift : shifts) {
    const cpu::TranslationMatrix<T> matrix = shift.first(coefficients);
    const std::size_t elements = add_groups(matrix, offset, groups);
    data.insert(data.end(), matrix.data, matrix.data + elements);
  }
  return {upload(device, data), upload(device, groups), nullptr, nullptr};
}

template <class T>
MatricesOnDevice upload_matrices(Device& device, const std::vector<Offset>& offsets, const M2lMatrices<T>& matrices, std::size_t stride) {
  MatricesOnDevice out;
  std::vector<T> signs;
  for (std::int32_t mirror = 0; mirror < static_cast<std::int32_t>(kMirrors); ++mirror) {
    const Offset image{0, {mirror & 1 ? -1 : 1, mirror & 2 ? -1 : 1, mirror & 4 ? -1 : 1}};
    signs.insert(signs.end(), matrices.signs(image), matrices.signs(image) + stride);
  }
  const std::size_t count = offsets.empty() ? 0 : matrices.index(offsets.size() - 1) + 1;
  std::vector<Uint4> groups;
  std::vector<Uint4> shapes;
  std::vector<std::size_t> first_element(1, 0);
  std::size_t offset = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const cpu::TranslationMatrix<T> shape = matrices.shape(k);
    shapes.push_back({narrow(groups.size()), narrow(shape.groups), shape.most_columns, 0});
    first_element.push_back(first_element.back() + add_groups(shape, offset, groups));
  }
  out.data = device.allocate(first_element.back() * sizeof(T));
  std::vector<T> batch;
  for (std::size_t first = 0; first < count; first += kMatrixBatch) {
    const std::size_t last = std::min(first + kMatrixBatch, count);
    batch.resize(first_element[last] - first_element[first]);
    parallel::for_each(last - first, [&](std::size_t i) {
      AlignedVector<T> made;
      const cpu::TranslationMatrix<T> matrix = matrices.matrix(first + i, made);
      const std::size_t elements = first_element[first + i + 1] - first_element[first + i];
      std::copy_n(matrix.data, elements, batch.data() + (first_element[first + i] - first_element[first]));
    });
    device.write(*out.data, first_element[first] * sizeof(T), batch.data(), batch.size() * sizeof(T));
  }
  out.groups = upload(device, groups);
  out.shapes = upload(device, shapes);
  out.signs = upload(device, signs);
  return out;
}

// The pairs of every chunk, ascending by offset and so by matrix: chunk c has those from begin[c] on.
struct PairsOfChunks {
  std::vector<std::uint32_t> begin;
  UnsetVector<NumberedPair> pairs;
};

PairsOfChunks pairs_of_chunks(const InteractionLists& lists, std::size_t nodes, std::size_t chunk_nodes,
                              const std::vector<std::uint32_t>& number) {
  const auto for_pairs = [&](const auto& use) {
    parallel::for_each(lists.far_begin.size() - 1, [&](std::size_t part) {
      auto pair = lists.far.begin() + static_cast<std::ptrdiff_t>(lists.far_begin[part]);
      for (std::size_t r = lists.run_begin[part]; r < lists.run_begin[part + 1]; ++r) {
        for (std::uint32_t k = 0; k < lists.runs[r].pairs; ++k, ++pair) {
          const std::uint32_t target = number.empty() ? pair->target : number[pair->target];
          if (target != kNotInPart) use(target / chunk_nodes, FarPair{target, pair->source}, lists.runs[r].offset);
        }
      }
    });
  };
  const std::size_t chunks = (nodes + chunk_nodes - 1) / chunk_nodes;
  std::vector<std::atomic<std::uint32_t>> next(chunks);
  for_pairs([&](std::size_t c, const FarPair&, std::uint32_t) { next[c].fetch_add(1, std::memory_order_relaxed); });
  PairsOfChunks out;
  out.begin.assign(1, 0);
  for (std::atomic<std::uint32_t>& n : next) {
    out.begin.push_back(out.begin.back() + n.load());
    n = out.begin[out.begin.size() - 2];
  }
  out.pairs.resize(out.begin.back());
  for_pairs([&](std::size_t c, const FarPair& pair, std::uint32_t offset) {
    out.pairs[next[c].fetch_add(1, std::memory_order_relaxed)] = {pair, offset};
  });
  const auto place = [](const NumberedPair& p) { return std::tuple(p.offset, p.pair.target, p.pair.source); };
  parallel::for_all(chunks, [&](std::size_t c) {  // into an order that no thread has a part in
    std::sort(out.pairs.begin() + out.begin[c], out.pairs.begin() + out.begin[c + 1],
              [&](const NumberedPair& a, const NumberedPair& b) { return place(a) < place(b); });
  });
  return out;
}

// The tiles of pairs [begin, end) of one chunk at the end of `tiles`, and the pairs into their places of `tiled`.
void tile_chunk(const InteractionLists& lists, const NumberedPair* begin, const NumberedPair* end,
                const std::vector<std::uint32_t>& matrix_of, std::uint32_t first_pair, Uint4* tiled, std::vector<Uint4>& tiles) {
  const std::size_t of_others = tiles.size();
  std::uint32_t done = first_pair;
  for (const NumberedPair* p = begin; p != end; ++p, ++tiled, ++done) {
    const Offset& offset = lists.offsets[p->offset];
    const std::uint32_t target = p->pair.target;
    const std::uint32_t matrix = matrix_of[p->offset];
    const std::uint32_t flags = offset.mirror() | (offset.positive() ? kPositive : 0);
    const auto joins = [&](const Uint4& tile) {
      if (tile[0] != matrix || tile[2] == kMostTilePairs) return false;
      if (tile[3] != (flags & kPositive)) return false;
      return std::none_of(tiled - tile[2], tiled, [&](const Uint4& other) { return other[0] == target; });
    };
    if (tiles.size() == of_others || !joins(tiles.back())) tiles.push_back({matrix, done, 0, flags & kPositive});
    ++tiles.back()[2];
    *tiled = {target, p->pair.source, flags, 0};
  }
}

}  // namespace

std::uint32_t narrow(std::size_t value) {
  if (value > std::numeric_limits<std::uint32_t>::max()) throw DeviceError("too many points for the device");
  return static_cast<std::uint32_t>(value);
}

TreeOnDevice::TreeOnDevice(Device& device, const Octree& tree) {
  std::vector<Int4> centre_of;
  std::vector<Uint2> children_of;
  std::vector<std::uint32_t> parent_of;
  std::vector<std::uint32_t> octant_of;
  for (const OctreeNode& node : tree.nodes) {
    centre_of.push_back(centre(node));
    children_of.push_back({node.first_child, node.child_count});
    parent_of.push_back(node.parent);
    octant_of.push_back(static_cast<std::uint32_t>((node.cell[0] & 1) * 4 + (node.cell[1] & 1) * 2 + (node.cell[2] & 1)));
  }
  std::vector<Uint2> points_of;
  std::vector<Int4> leaf_centre_of;
  for (const std::uint32_t leaf : tree.leaves) {
    points_of.push_back({tree.nodes[leaf].begin, tree.nodes[leaf].count()});
    leaf_centre_of.push_back(centre_of[leaf]);
  }
  centres = upload(device, centre_of);
  children = upload(device, children_of);
  parents = upload(device, parent_of);
  octants = upload(device, octant_of);
  leaf_nodes = upload(device, tree.leaves);
  leaf_points = upload(device, points_of);
  leaf_centres = upload(device, leaf_centre_of);
}

PartOfTree part_of_tree(const Octree& tree, std::size_t first_leaf, std::size_t end_leaf) {
  const std::uint32_t first_point = tree.nodes[tree.leaves[first_leaf]].begin;
  const std::uint32_t end_point = tree.nodes[tree.leaves[end_leaf - 1]].end;
  PartOfTree out;
  out.number.assign(tree.nodes.size(), kNotInPart);
  out.tree.level_begin.push_back(0);
  for (std::size_t level = 0; level < tree.levels(); ++level) {
    for (std::uint32_t i = tree.level_begin[level]; i < tree.level_begin[level + 1]; ++i) {
      OctreeNode node = tree.nodes[i];
      if (node.end <= first_point || node.begin >= end_point) continue;
      out.number[i] = narrow(out.tree.nodes.size());
      node.parent = out.number[node.parent];
      node.first_child = node.child_count = 0;
      out.tree.nodes.push_back(node);
    }
    out.tree.level_begin.push_back(narrow(out.tree.nodes.size()));
  }
  for (std::size_t i = first_leaf; i < end_leaf; ++i) out.tree.leaves.push_back(out.number[tree.leaves[i]]);
  return out;
}

TiledPairs tile_pairs(const InteractionLists& lists, std::size_t nodes, std::size_t chunk_nodes,
                      const std::vector<std::uint32_t>& matrix_of, const std::vector<std::uint32_t>& number) {
  (void)narrow(lists.far.size());
  const PairsOfChunks of_chunks = pairs_of_chunks(lists, nodes, chunk_nodes, number);
  const std::size_t chunks = of_chunks.begin.size() - 1;
  TiledPairs out;
  out.pairs.resize(of_chunks.pairs.size());
  out.chunk_tiles.resize(chunks + 1);
  std::vector<std::vector<Uint4>> tiles_of((chunks + kChunkBlock - 1) / kChunkBlock);
  parallel::for_blocks(chunks, kChunkBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<Uint4>& tiles = tiles_of[begin / kChunkBlock];
    for (std::size_t c = begin; c < end; ++c) {
      const NumberedPair* const pairs = of_chunks.pairs.data();
      tile_chunk(lists, pairs + of_chunks.begin[c], pairs + of_chunks.begin[c + 1], matrix_of, of_chunks.begin[c],
                 out.pairs.data() + of_chunks.begin[c], tiles);
      out.chunk_tiles[c + 1] = static_cast<std::uint32_t>(tiles.size());  // of the block, so far
    }
  });
  std::vector<std::uint32_t> first(1, 0);
  for (const std::vector<Uint4>& tiles : tiles_of) first.push_back(first.back() + static_cast<std::uint32_t>(tiles.size()));
  out.tiles.resize(first.back());
  parallel::for_each(tiles_of.size(), [&](std::size_t b) {
    std::copy(tiles_of[b].begin(), tiles_of[b].end(), out.tiles.begin() + first[b]);
    for (std::size_t c = b * kChunkBlock; c < std::min(chunks, (b + 1) * kChunkBlock); ++c) out.chunk_tiles[c + 1] += first[b];
  });
  return out;
}

template <class T>
ListsOnDevice<T>::ListsOnDevice(Device& device, const Octree& targets, const Octree& sources,
                                std::shared_ptr<const TreeOnDevice> source_tree, const InteractionLists& lists)
    : device_(device), targets_(targets), source_octree_(sources), lists_(lists), source_tree_(std::move(source_tree)) {}

template <class T>
TargetsOnDevice ListsOnDevice<T>::make_part(std::size_t first_leaf, std::size_t end_leaf) const {
  TargetsOnDevice part;
  part.first_leaf = first_leaf;
  part.leaves = end_leaf - first_leaf;
  const bool all = part.leaves == targets_.leaves.size();
  PartOfTree some;
  if (!all) some = part_of_tree(targets_, first_leaf, end_leaf);
  const Octree& tree = all ? targets_ : some.tree;
  part.nodes = tree.nodes.size();
  part.level_begin = tree.level_begin;
  part.chunk_nodes = chunk_nodes_for(part.nodes, device_.info().software);
  part.tree = &tree == &source_octree_ ? source_tree_ : std::make_shared<TreeOnDevice>(device_, tree);
  part.number = std::move(some.number);
  add_near(part);
  return part;
}

template <class T>
void ListsOnDevice<T>::add_near(TargetsOnDevice& part) const {
  const std::size_t first = lists_.near_begin[part.first_leaf];
  const std::size_t end = lists_.near_begin[part.first_leaf + part.leaves];
  std::vector<std::uint32_t> begin;
  for (std::size_t i = 0; i <= part.leaves; ++i) begin.push_back(narrow(lists_.near_begin[part.first_leaf + i] - first));
  part.near_begin = upload(device_, begin);
  const std::vector<std::uint32_t> leaves(lists_.near.begin() + static_cast<std::ptrdiff_t>(first),
                                          lists_.near.begin() + static_cast<std::ptrdiff_t>(end));
  part.near_leaves = upload(device_, leaves);
  std::vector<std::uint32_t> points(1, 0);
  points.reserve(leaves.size() + 1);
  for (const std::uint32_t leaf : leaves) points.push_back(points.back() + source_octree_.nodes[source_octree_.leaves[leaf]].count());
  part.near_points = upload(device_, points);
  std::vector<std::uint32_t> order(part.leaves);
  std::iota(order.begin(), order.end(), 0U);
  const auto cost = [&](std::uint32_t leaf) { return points[begin[leaf + 1]] - points[begin[leaf]]; };
  parallel::sort(order.begin(), order.end(),
                 [&](std::uint32_t a, std::uint32_t b) { return std::pair(cost(b), a) < std::pair(cost(a), b); });
  part.near_order = upload(device_, order);
}

template <class T>
void ListsOnDevice<T>::prepare_near() {
  if (!parts_.empty()) return;
  std::vector<TargetsOnDevice> made;
  const std::size_t leaves = targets_.leaves.size();
  for (std::size_t p = 0; p < wanted_parts_; ++p) made.push_back(make_part(leaves * p / wanted_parts_, leaves * (p + 1) / wanted_parts_));
  parts_ = std::move(made);
}

template <class T>
void ListsOnDevice<T>::prepare_far(const M2lMatrices<T>& matrices, int order, const Shifts<T>& shifts, std::size_t coefficients) {
  for (TargetsOnDevice& part : parts_) {
    if (part.pairs) continue;
    std::vector<std::uint32_t> matrix_of(lists_.offsets.size());
    for (std::size_t i = 0; i < matrix_of.size(); ++i) matrix_of[i] = narrow(matrices.index(i));
    const TiledPairs tiled = tile_pairs(lists_, part.nodes, part.chunk_nodes, matrix_of, part.number);
    part.chunks = tiled.chunk_tiles.size() - 1;
    part.chunk_tiles = upload(device_, tiled.chunk_tiles);
    part.tiles = upload(device_, tiled.tiles);
    part.pairs = upload(device_, tiled.pairs);  // the last: tells that all are there
    std::vector<std::uint32_t>().swap(part.number);
  }
  if (!up_.data) {
    down_ = upload_shifts(device_, shifts.parent_to_child, coefficients);
    up_ = upload_shifts(device_, shifts.child_to_parent, coefficients);  // the last: tells that both are there
  }
  if (matrices_.count(order) == 0) {
    const std::size_t n = coefficient_count(order);
    matrices_.emplace(order, upload_matrices(device_, lists_.offsets, matrices, cpu::padded_count(n)));
  }
}

template <class T>
Buffer& ListsOnDevice<T>::locals(std::size_t each) {
  std::size_t nodes = 0;
  for (const TargetsOnDevice& part : parts_) nodes = std::max(nodes, part.nodes);
  const std::size_t bytes = nodes * each * sizeof(T);
  wanted_locals_ = std::max(wanted_locals_, bytes);
  if (!locals_ || locals_->bytes() < bytes) {
    locals_.reset();  // not twice in memory
    locals_ = device_.allocate(bytes);
  }
  return *locals_;
}

template <class T>
bool ListsOnDevice<T>::cut_finer() {
  if (wanted_locals_ == 0 || 2 * wanted_parts_ > std::min(kMostParts, targets_.leaves.size())) return false;
  wanted_parts_ *= 2;
  wanted_locals_ = 0;
  locals_.reset();
  parts_.clear();
  return true;
}

template class ListsOnDevice<float>;
template class ListsOnDevice<double>;

}  // namespace g3r::gpu
