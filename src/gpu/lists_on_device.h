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
/// `number`: of every target, or kNotInPart; empty: targets have their own numbers.
[[nodiscard]] TiledPairs tile_pairs(const InteractionLists& lists, std::size_t nodes, std::size_t chunk_nodes,
                                    const std::vector<std::uint32_t>& matrix_of, const std::vector<std::uint32_t>& number = {});
inline constexpr std::uint32_t kNotInPart = 0xFFFFFFFF;

/// Some consecutive leaves of a tree and the nodes above them, in their order and numbered by it; points keep their numbers.
struct PartOfTree {
  Octree tree;                        ///< without children
  std::vector<std::uint32_t> number;  ///< of every node of the whole tree, or kNotInPart
};
[[nodiscard]] PartOfTree part_of_tree(const Octree& tree, std::size_t first_leaf, std::size_t end_leaf);

/// Targets that are worked on together: all, or those of some consecutive leaves.
struct TargetsOnDevice {
  std::size_t first_leaf = 0, leaves = 0;  ///< in the order of their points
  std::size_t nodes = 0;
  std::vector<std::uint32_t> level_begin;    ///< as that of an Octree
  std::vector<std::uint32_t> number;         ///< PartOfTree::number, empty for all
  std::shared_ptr<const TreeOnDevice> tree;  ///< of these nodes
  std::unique_ptr<Buffer> near_begin, near_leaves;
  std::unique_ptr<Buffer> near_points;  ///< points of the leaves before each one of near_leaves, and of all, modulo 2^32
  std::unique_ptr<Buffer> near_order;   ///< leaves by what their near field costs, the most first: one that takes long has to begin early
  std::size_t chunk_nodes = 0, chunks = 0;
  std::unique_ptr<Buffer> chunk_tiles, tiles, pairs;  ///< TiledPairs
};

/// Throws DeviceError, std::bad_alloc. Built once per tree and lists; matrices when an order is first used.
template <class T>
class ListsOnDevice {
 public:
  /// `source_tree`: `sources` on the device. All must outlive it.
  ListsOnDevice(Device& device, const Octree& targets, const Octree& sources, std::shared_ptr<const TreeOnDevice> source_tree,
                const InteractionLists& lists);

  [[nodiscard]] const TreeOnDevice& sources() const { return *source_tree_; }
  /// The targets, part by part.
  [[nodiscard]] const std::vector<TargetsOnDevice>& parts() const { return parts_; }
  /// Room for `each` numbers for every node of the largest part, for one sum at a time.
  [[nodiscard]] Buffer& locals(std::size_t each);

  /// Uploads what the near field needs, unless it is there.
  void prepare_near();
  /// Uploads what the far field of one order needs, unless it is there.
  void prepare_far(const M2lMatrices<T>& matrices, int order, const Shifts<T>& shifts, std::size_t coefficients);
  /// Twice as many parts, to be prepared again, and no locals; false where that would save next to nothing. Lists are there for all parts.
  /// What comes of a target does not depend on its part.
  [[nodiscard]] bool cut_finer();
  [[nodiscard]] const MatricesOnDevice& matrices(int order) const { return matrices_.at(order); }
  [[nodiscard]] const MatricesOnDevice& child_to_parent() const { return up_; }
  [[nodiscard]] const MatricesOnDevice& parent_to_child() const { return down_; }

 private:
  [[nodiscard]] TargetsOnDevice make_part(std::size_t first_leaf, std::size_t end_leaf) const;
  void add_near(TargetsOnDevice& part) const;

  Device& device_;
  const Octree& targets_;
  const Octree& source_octree_;
  const InteractionLists& lists_;
  std::shared_ptr<const TreeOnDevice> source_tree_;
  std::size_t wanted_parts_ = 1;
  std::vector<TargetsOnDevice> parts_;  // none before they are prepared
  std::unique_ptr<Buffer> locals_;
  std::size_t wanted_locals_ = 0;  // bytes
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
