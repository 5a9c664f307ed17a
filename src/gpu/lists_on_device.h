// Trees, interaction lists and translation matrices on a device: what all sums over them share. Internal to src/sum and src/gpu.
#pragma once

#include "cpu/aligned_vector.h"
#include "cpu/translations.h"
#include "expansions/m2l_matrices.h"
#include "gpu/device.h"
#include "tree/interaction_lists.h"
#include "tree/octree.h"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

namespace g3r::gpu {

/// Kernels count in 32 bits. Throws DeviceError where that is not enough.
[[nodiscard]] std::uint32_t narrow(std::size_t value);
/// Of small numbers.
[[nodiscard]] inline int as_int(std::size_t value) { return static_cast<int>(value); }

/// A tree, node by node in its own order, and leaf by leaf. Centres are (x, y, z, level) in units of 2^-21, exact.
struct TreeOnDevice {
  std::unique_ptr<Buffer> centres;       ///< int4 of every node
  std::unique_ptr<Buffer> children;      ///< uint2 of every node: first, number
  std::unique_ptr<Buffer> parents;       ///< uint of every node
  std::unique_ptr<Buffer> octants;       ///< uint of every node
  std::unique_ptr<Buffer> leaf_nodes;    ///< uint of every leaf
  std::unique_ptr<Buffer> leaf_points;   ///< uint2 of every leaf: first, number
  std::unique_ptr<Buffer> leaf_centres;  ///< int4 of every leaf

  TreeOnDevice(Device& device, const Octree& tree);
};

/// Matrices in the layout of the kernels: groups of rows (offset / kLanes, first column, last column, -), and where each matrix has its
/// own.
struct MatricesOnDevice {
  std::unique_ptr<Buffer> data;
  std::unique_ptr<Buffer> groups;  ///< uint4
  std::unique_ptr<Buffer> shapes;  ///< uint4 of every matrix: first group, groups, columns, -; M2L only
  std::unique_ptr<Buffer> signs;   ///< of every mirror image; M2L only
};

/// The moves between a node and its parent, by octant.
template <class T>
struct Shifts {
  const std::array<StoredTranslation<T>, 8>& child_to_parent;
  const std::array<StoredTranslation<T>, 8>& parent_to_child;
};

/// Pairs of a chunk of targets that share a matrix, in tiles whose targets differ.
struct TiledPairs {
  std::vector<std::uint32_t> chunk_tiles;           ///< before every chunk, and all
  UnsetVector<std::array<std::uint32_t, 4>> tiles;  ///< matrix, first pair, pairs, kPositive or 0
  UnsetVector<std::array<std::uint32_t, 4>> pairs;  ///< target, source, mirror image | kPositive, 0
};
inline constexpr std::size_t kMostTilePairs = 16;  ///< more share no more, for the matrix is in a cache by then
inline constexpr std::uint32_t kPositive = 8;      ///< Offset::positive()

/// `nodes` targets, of which a chunk has `chunk_nodes`. `matrix_of`: M2lMatrices::index().
[[nodiscard]] TiledPairs tile_pairs(const InteractionLists& lists, std::size_t nodes, std::size_t chunk_nodes,
                                    const std::vector<std::uint32_t>& matrix_of);

/// Throws DeviceError, std::bad_alloc. Built once per tree and lists; matrices when an order is first used.
template <class T>
class ListsOnDevice {
 public:
  /// `source_tree`: `sources` on the device.
  ListsOnDevice(Device& device, const Octree& targets, const Octree& sources, std::shared_ptr<const TreeOnDevice> source_tree,
                const InteractionLists& lists);

  [[nodiscard]] const TreeOnDevice& targets() const { return target_tree_ ? *target_tree_ : *source_tree_; }
  [[nodiscard]] const TreeOnDevice& sources() const { return *source_tree_; }
  [[nodiscard]] const Buffer& near_begin() const { return *near_begin_; }
  [[nodiscard]] const Buffer& near_leaves() const { return *near_leaves_; }
  /// Points of the leaves before each one of near_leaves(), and of all.
  [[nodiscard]] const Buffer& near_points() const { return *near_points_; }
  /// Target leaves by what their near field costs, the most first: one that takes long has to begin early.
  [[nodiscard]] const Buffer& near_order() const { return *near_order_; }
  [[nodiscard]] const Buffer& chunk_tiles() const { return *chunk_tiles_; }
  [[nodiscard]] const Buffer& tiles() const { return *tiles_; }
  [[nodiscard]] const Buffer& pairs() const { return *pairs_; }
  [[nodiscard]] std::size_t chunks() const { return chunks_; }
  [[nodiscard]] std::size_t chunk_nodes() const { return chunk_nodes_; }

  /// Uploads what the far field of one order needs, unless it is there.
  void prepare_far(const M2lMatrices<T>& matrices, int order, const Shifts<T>& shifts, std::size_t coefficients);
  [[nodiscard]] const MatricesOnDevice& matrices(int order) const { return matrices_.at(order); }
  [[nodiscard]] const MatricesOnDevice& child_to_parent() const { return up_; }
  [[nodiscard]] const MatricesOnDevice& parent_to_child() const { return down_; }

 private:
  Device& device_;
  const InteractionLists& lists_;
  std::size_t target_nodes_;
  std::shared_ptr<const TreeOnDevice> source_tree_;
  std::unique_ptr<TreeOnDevice> target_tree_;  // null: the sources' tree
  std::unique_ptr<Buffer> near_begin_, near_leaves_, near_points_, near_order_;
  std::size_t chunk_nodes_;
  std::size_t chunks_ = 0;
  std::unique_ptr<Buffer> chunk_tiles_, tiles_, pairs_;
  std::map<int, MatricesOnDevice> matrices_;
  MatricesOnDevice up_, down_;
};

/// Uploads a vector.
template <class Vector>
[[nodiscard]] std::unique_ptr<Buffer> upload(Device& device, const Vector& values) {
  const std::size_t bytes = values.size() * sizeof values[0];
  std::unique_ptr<Buffer> buffer = device.allocate(bytes);
  device.write(*buffer, 0, values.data(), bytes);
  return buffer;
}

extern template class ListsOnDevice<float>;
extern template class ListsOnDevice<double>;

}  // namespace g3r::gpu
