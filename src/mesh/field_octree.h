// An adaptive octree over a cube, refined near given points, with its corners numbered. Flat arrays, children addressed by index.
// No balance between neighbouring leaves is needed or made.
#pragma once

#include <g3r/points.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

namespace g3r::mesh {

/// The children of a split node, and the corners of each: one for each combination of lower and upper along three axes.
inline constexpr std::uint32_t kOctants = 1U << std::tuple_size_v<Vec3>;
/// The quadrants around an edge, and so the leaves.
inline constexpr std::uint32_t kQuadrants = kOctants / 2;
/// Eight siblings have 27 corners, on a lattice of 3 x 3 x 3.
inline constexpr std::uint32_t kLatticeSide = 3, kLatticeSize = kLatticeSide * kLatticeSide * kLatticeSide;
/// Place on this lattice of the corner of the first sibling at the upper end of the axes whose bits are set; the place of a corner of
/// another sibling is the sum of its own and that of the sibling.
constexpr std::uint32_t lattice_place(std::uint32_t bits) {
  return (bits & 1U) + kLatticeSide * (((bits >> 1U) & 1U) + kLatticeSide * (bits >> 2U));
}

/// Deepest level: three corner coordinates, each with a bit more, fit in a 64-bit key.
inline constexpr int kMaxOctreeLevel = std::numeric_limits<std::uint64_t>::digits / 3 - 1;

/// A request: leaves that touch the disc around `centre` of the given radius and half thickness are at least `level` deep.
struct RefineDisc {
  Vec3 centre;
  Vec3 normal{0, 0, 0};  ///< unit; zero asks for a ball
  double radius = 0;
  double half_thickness = 0;
  int level = 0;
};

struct OctreeNode {
  std::array<std::uint32_t, 3> low{};  ///< lower corner, in units of the smallest possible cell
  /// Of a split node, its first child: children are 8 consecutive nodes, child bit a set = upper half along axis a. Of a leaf, its number.
  std::uint32_t next = 0;
  std::uint8_t level = 0;  ///< 0 = root
  bool split = false;
};

/// An edge of a leaf that no smaller leaf's edge subdivides.
struct MinimalEdge {
  std::uint32_t low = 0, high = 0;               ///< corners
  std::array<std::uint32_t, kQuadrants> leaf{};  ///< around it, in order; a leaf twice as large may fill two adjacent places
  std::uint8_t axis = 0;                         ///< direction

  /// Whether the k-th leaf fills the place before it too.
  [[nodiscard]] bool is_repeated(std::size_t k) const { return leaf[k] == leaf[(k + kQuadrants - 1) % kQuadrants]; }
};

/// Whether a node is split.
enum class Split : std::uint8_t {
  kNo,           ///< whatever is requested in it
  kAsRequested,  ///< where a request that touches it wants deeper leaves
  kYes
};
using SplitRule = std::function<Split(const OctreeNode&)>;

class Octree {
 public:
  /// The cube [low, low + side]^3 refined as requested, every leaf at least at `base_level`. O(requests x touched leaves).
  /// Throws Cancelled.
  Octree(const Vec3& low, double side, const std::vector<RefineDisc>& requests, int base_level, const std::atomic<bool>* cancel = nullptr);
  /// The same with nodes split by a rule.
  Octree(const Vec3& low, double side, const std::vector<RefineDisc>& requests, const SplitRule& rule,
         const std::atomic<bool>* cancel = nullptr);

  [[nodiscard]] std::size_t node_count() const { return nodes_.size(); }
  [[nodiscard]] OctreeNode node(std::uint32_t n) const {
    OctreeNode out{families_[family(n)].low, nodes_[n].next, level_of(n), is_split(n)};
    for (std::size_t a = 0; a < 3; ++a) out.low[a] += n == 0 ? 0 : ((sibling(n) >> a) & 1U) * extent(out);
    return out;
  }
  /// Of node(n), each alone.
  [[nodiscard]] bool is_split(std::uint32_t n) const { return nodes_[n].split != 0; }
  [[nodiscard]] std::uint32_t next_of(std::uint32_t n) const { return nodes_[n].next; }
  [[nodiscard]] std::uint8_t level_of(std::uint32_t n) const { return n == 0 ? 0 : families_[family(n)].level; }
  [[nodiscard]] std::size_t leaf_count() const { return leaf_nodes_.size(); }
  /// Node index of each leaf.
  [[nodiscard]] const std::vector<std::uint32_t>& leaf_nodes() const { return leaf_nodes_; }
  [[nodiscard]] OctreeNode leaf(std::size_t number) const { return node(leaf_nodes_[number]); }
  /// Number of a leaf's corner, bit a of `place` set = upper along axis a.
  [[nodiscard]] std::uint32_t corner(std::size_t leaf, std::uint32_t place) const {
    const std::uint32_t node = leaf_nodes_[leaf];
    return family_corners_[family(node)][kLatticePlace[sibling(node)] + kLatticePlace[place]];
  }
  /// All eight of them.
  [[nodiscard]] std::array<std::uint32_t, kOctants> corners(std::size_t leaf) const {
    std::array<std::uint32_t, kOctants> out{};
    for (std::uint32_t place = 0; place < kOctants; ++place) out[place] = corner(leaf, place);
    return out;
  }
  [[nodiscard]] std::size_t corner_count() const { return corner_places_.size(); }
  /// Integer coordinates of a corner, in units of the smallest possible cell.
  [[nodiscard]] std::array<std::uint32_t, 3> corner_grid(std::size_t corner) const;
  [[nodiscard]] bool on_boundary(std::size_t corner) const;
  /// World coordinates of integer coordinates (fractions allowed).
  [[nodiscard]] Vec3 world(double x, double y, double z) const { return {low_[0] + x * unit_, low_[1] + y * unit_, low_[2] + z * unit_}; }
  [[nodiscard]] Vec3 corner_position(std::size_t corner) const;
  /// Side of a node, in units of the smallest possible cell.
  [[nodiscard]] std::uint32_t extent(const OctreeNode& node) const { return std::uint32_t{1} << (kMaxOctreeLevel - node.level); }
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] int depth() const { return depth_; }

 private:
  // lattice_place() of each combination of bits.
  static constexpr std::array<std::uint32_t, kOctants> kLatticePlace = [] {
    std::array<std::uint32_t, kOctants> out{};
    for (std::uint32_t bits = 0; bits < kOctants; ++bits) out[bits] = lattice_place(bits);
    return out;
  }();
  static std::size_t family(std::uint32_t node) { return node == 0 ? 0 : (node - 1) / kOctants; }
  static std::uint32_t sibling(std::uint32_t node) { return node == 0 ? 0 : (node - 1) % kOctants; }
  struct Frontier;  // nodes of one level that are still to be looked at, with the requests that touch each of them
  void refine(const std::vector<RefineDisc>& requests, const SplitRule& rule, const std::atomic<bool>* cancel);
  [[nodiscard]] std::vector<std::size_t> split_nodes(const Frontier& front, int level, const std::vector<RefineDisc>& requests,
                                                     const SplitRule& rule, const std::atomic<bool>* cancel);
  [[nodiscard]] Frontier children_of(const Frontier& front, const std::vector<std::size_t>& split, int level,
                                     const std::vector<RefineDisc>& requests, const std::atomic<bool>* cancel) const;
  void number_corners(const std::atomic<bool>* cancel);

  Vec3 low_;
  double unit_ = 1;
  int depth_ = 0;
  // Nodes are most of the memory: what eight siblings share is held once, so that one takes 6 bytes where OctreeNode has 20.
  struct Node {
    std::uint32_t next : 31;
    std::uint32_t split : 1;
  };
  struct Family {
    std::array<std::uint32_t, 3> low{};  // of the parent
    std::uint8_t level = 0;              // of the siblings
  };
  std::vector<Node> nodes_;
  std::vector<Family> families_;
  std::vector<std::uint32_t> leaf_nodes_;
  std::vector<std::array<std::uint32_t, kLatticeSize>> family_corners_;  // 108 bytes where its leaves' own would take up to 256
  std::vector<std::uint32_t> corner_places_;                             // of each corner, one of its places among these
};

}  // namespace g3r::mesh
