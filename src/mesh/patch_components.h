// The patches of a surface around octree corners whose signs may change, and which of them hang together, through the rest of it too.
#pragma once

#include "base/disjoint_sets.h"
#include "mesh/field_contour.h"
#include "mesh/open_edges.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace g3r::mesh {

/// Twice the Euler characteristic of a patch, half of each of its arcs counted; a patch is a vertex, an arc an edge, a crossing a face.
[[nodiscard]] inline long twice_characteristic(const Patches& s, std::size_t patch) {
  return 2 - static_cast<long>(s.begin[patch + 1] - s.begin[patch]);
}

/// Handles of so many components of closed surface with twice their Euler characteristic chi: genus = components - chi / 2. Of changes of
/// both it is the change of the handles.
[[nodiscard]] constexpr long handles_of(long components, long twice_chi) { return components - twice_chi / 2 / 2; }

/// Handles of all components together. O(patches + crossings).
[[nodiscard]] long count_handles(const DualSurface& surface);

/// The surface outside the leaves around open edges, which never changes: which of the crossings between the two are connected through it.
struct SurfaceElsewhere {
  struct Crossing {
    std::uint64_t corners = 0;  ///< the one inside first
    std::uint32_t part = 0;
    bool operator<(const Crossing& other) const { return corners < other.corners; }
  };
  SomeLeaves around;                ///< the leaves
  std::vector<Crossing> crossings;  ///< ascending
  std::size_t parts = 0;
};
/// `surface`: patches_of() the octree, freed. O(crossings).
[[nodiscard]] SurfaceElsewhere surface_elsewhere(SomeLeaves around, DualSurface&& surface);

/// The patches in the leaves around open edges.
class PatchComponents {
 public:
  /// `open` and `elsewhere` must outlive this. O(edges near open corners).
  PatchComponents(const OpenEdges& open, const SurfaceElsewhere& elsewhere, Patches patches);

  [[nodiscard]] const Patches& patches() const { return patches_; }
  /// Components of the whole surface.
  [[nodiscard]] std::size_t count() const { return count_; }
  /// The component of one of the patches.
  [[nodiscard]] std::uint32_t of(std::size_t patch) const { return component_[node_[patches_.rim[patches_.begin[patch]]]]; }
  /// Takes the patches of `changed` in place of those there are in the leaves for which taken(leaf).
  void exchange(const Patches& changed, const LeafTest& taken);

 private:
  friend class TriedExchange;
  void number_nodes();
  void join();

  const OpenEdges& open_;
  const SurfaceElsewhere& elsewhere_;
  Patches patches_;
  std::vector<std::uint32_t> node_;       // of edges: the part it crosses, another number if it crosses between these leaves only, or kNone
  std::vector<std::uint32_t> component_;  // of nodes
  std::size_t count_ = 0;
};

/// What the components would be after an exchange, for some choices of leaves.
class TriedExchange {
 public:
  /// `may_be_taken`: the leaves of `changed`; the patches of all others stay. All must outlive this. O(patches near open corners).
  TriedExchange(const PatchComponents& now, const Patches& changed, LeafTest may_be_taken);

  /// The component of each patch of `changed` for which taken(leaf), and else kNone, once these are exchanged.
  [[nodiscard]] std::vector<std::uint32_t> components(const LeafTest& taken) const;

 private:
  const PatchComponents& now_;
  const Patches& changed_;
  LeafTest may_be_taken_;
  std::vector<std::uint32_t> node_;  // of edges, those too that cross in `changed` only
  DisjointSets elsewhere_;           // joined by the patches that stay
};

}  // namespace g3r::mesh
