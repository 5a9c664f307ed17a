// Where the sources and targets of a sum are, in their trees, and how nodes interact. Internal to src/sum.
#pragma once

#include "cpu/aligned_vector.h"
#include "cpu/far_field.h"
#include "expansions/m2l_matrices.h"
#include "sum/direct_sum.h"
#include "sum/sum_plan.h"
#include "tree/interaction_lists.h"
#include "tree/octree.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace g3r::gpu {
struct TreeOnDevice;
template <class T>
class ListsOnDevice;
}  // namespace g3r::gpu

namespace g3r {

/// The geometry of sums in precision T: cheap to copy with other widths or targets, as the parts are shared.
template <class T>
class SumGeometry {
 public:
  /// x, y and z of points relative to the centre of their leaf: one field after the other, a stride apart.
  using Places = AlignedVector<T>;
  /// What belongs to the sources, shared by geometries with other targets or widths.
  struct Sources {
    std::size_t count = 0;
    Octree tree;  ///< its nodes know the widest widths
    Places places;
    std::array<StoredTranslation<T>, 8> child_to_parent;  ///< M2M by octant
    std::array<StoredTranslation<T>, 8> parent_to_child;  ///< L2L by octant
    std::shared_ptr<gpu::TreeOnDevice> tree_on_device;
  };

  /// Points in canonical order; the sources are also the targets.
  SumGeometry(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan);
  /// The same points with widths that are nowhere larger, in the tree and the lists of `other`, whose own targets are its sources.
  SumGeometry(const SumGeometry& other, const Widths& narrower);
  /// Another set of targets for the sources of `other`, canonical order: pairs have the width of the source.
  SumGeometry(const SumGeometry& other, const std::vector<Vec3>& targets);
  /// Takes other targets in place of those, canonical order.
  void set_targets(const std::vector<Vec3>& targets);

  [[nodiscard]] const SumPlan& plan() const { return plan_; }
  [[nodiscard]] const Sources& sources() const { return *sources_; }
  [[nodiscard]] const Octree& target_tree() const { return *target_tree_; }
  /// Whether the targets are other points than the sources.
  [[nodiscard]] bool has_own_targets() const { return !target_places_.empty(); }
  [[nodiscard]] const Places& target_places() const { return has_own_targets() ? target_places_ : sources_->places; }
  /// Elements from one field of the sources to the next: those past the end are readable.
  [[nodiscard]] std::size_t source_stride() const { return stride_of(sources_->count); }
  [[nodiscard]] std::size_t target_stride() const { return stride_of(target_tree_->nodes.front().count()); }

  [[nodiscard]] bool local_widths() const { return local_widths_; }
  /// Of the kernels, where they are uniform; of the first source where not.
  [[nodiscard]] double uniform_width() const { return widths_->uniform; }
  /// Of every source, with local widths; null without.
  [[nodiscard]] const T* squared_widths() const { return local_widths_ ? widths_->squared.data() : nullptr; }
  /// Of every target, with local widths: the pair's is the mean of both.
  [[nodiscard]] const T* target_squared_widths() const {
    return has_own_targets() ? target_places_.data() + 3 * target_stride() : squared_widths();
  }
  /// Of the kernel of this source.
  [[nodiscard]] double source_width(std::size_t source) const {
    return local_widths_ ? std::sqrt(static_cast<double>(widths_->squared[source])) : widths_->uniform;
  }

  /// Which nodes interact, and the matrices of far pairs with these terms: found when a sum first needs them, as sources that are only
  /// asked at other targets need none of their own.
  const InteractionLists& lists();
  const M2lMatrices<T>& matrices(const M2lTerms& terms);
  /// The tree of the sources and the lists on the plan's device, for the caller to make when it needs them.
  std::shared_ptr<gpu::TreeOnDevice>& tree_on_device() { return sources_->tree_on_device; }
  std::shared_ptr<gpu::ListsOnDevice<T>>& lists_on_device() { return interactions_->on_device; }

 private:
  struct SourceWidths {  // shared by geometries with other targets
    double uniform = 0;
    AlignedVector<T> squared;  // of every source, where they are not uniform
  };
  struct Interactions {  // shared by geometries with other widths
    std::optional<InteractionLists> lists;
    std::vector<std::unique_ptr<M2lMatrices<T>>> matrices;  // of every order
    std::shared_ptr<gpu::ListsOnDevice<T>> on_device;
  };

  static std::size_t stride_of(std::size_t points) { return cpu::padded_count(points) + cpu::kLanes; }
  void set_widths(const Widths& widths);

  SumPlan plan_;
  bool local_widths_;
  std::shared_ptr<Sources> sources_;
  std::shared_ptr<SourceWidths> widths_;
  std::shared_ptr<Octree> target_tree_;  // the sources' tree when they are the targets
  Places target_places_;                 // of others; with local widths their squares, 0, are the fourth field
  std::shared_ptr<Interactions> interactions_;
};

extern template class SumGeometry<float>;
extern template class SumGeometry<double>;

}  // namespace g3r
