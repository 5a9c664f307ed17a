// The engine behind every sum: trees, lists, expansions and near field, which do not know what they carry. Internal to src/sum.
#pragma once

#include "cpu/aligned_vector.h"
#include "cpu/far_field.h"
#include "cpu/near_field.h"
#include "expansions/m2l_matrices.h"
#include "sum/direct_sum.h"
#include "sum/sum_plan.h"
#include "tree/interaction_lists.h"
#include "tree/octree.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace g3r::gpu {
template <class T>
class ListsOnDevice;
template <class T>
class SumOnDevice;
}  // namespace g3r::gpu

namespace g3r {

/// Sums of one geometry in precision T. What a sum holds for every source is allocated on first use and reused; what it holds for targets
/// is made part by part of their tree. One caller at a time; parallel inside.
template <class T>
class SumEngine {
 public:
  /// What becomes of the sums at the targets [first, first + count): their blocks of cpu::kLanes x out_channels, channels of a target
  /// cpu::kLanes apart. Called from many threads, once for every target.
  using Take = std::function<void(std::uint32_t first, std::uint32_t count, const double* sums)>;

  /// Points in canonical order; the sources are also the targets.
  SumEngine(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel);
  /// The same points with widths that are nowhere larger, in the tree and the lists of `other`, whose own targets are its sources.
  SumEngine(const SumEngine& other, const Widths& narrower);
  /// Another set of targets for the sources of `other` (uniform width), canonical order.
  SumEngine(const SumEngine& other, const std::vector<Vec3>& targets, const std::atomic<bool>* cancel);

  /// Of the kernel of this source.
  [[nodiscard]] double source_width(std::size_t source) const {
    return local_widths_ ? std::sqrt(static_cast<double>(source_widths_->squared[source])) : source_widths_->uniform;
  }

  /// Takes other targets in place of those, canonical order; the values of the sources stay, and so does what was made of them.
  void set_targets(const std::vector<Vec3>& targets);

  /// Makes room for `values` values per source, for the caller to fill: the k-th of source i is value(k)[i].
  void begin_values(std::size_t values);
  [[nodiscard]] T* value(std::size_t k) { return values_.data() + k * source_stride(); }
  /// The same of `values` values per target, which are the sources.
  void begin_target_values(std::size_t values) { target_values_.resize(values * source_stride()); }
  [[nodiscard]] T* target_value(std::size_t k) { return target_values_.data() + k * source_stride(); }

  /// Runs a form over the values; sums are without 1/(4 pi).
  void run(cpu::NearForm form, int batch, std::size_t out_channels, const Take& take);

 private:
  // x, y and z of points relative to the centre of their leaf: fields as in values_.
  using Places = AlignedVector<T>;
  // What belongs to the sources, shared by engines with other targets or widths.
  struct Sources {
    std::size_t count = 0;
    Octree tree;  // its nodes know the widest widths
    Places places;
    std::array<StoredTranslation<T>, 8> child_to_parent;  // M2M by octant
    std::array<StoredTranslation<T>, 8> parent_to_child;  // L2L by octant
  };
  // Shared by engines with other targets.
  struct SourceWidths {
    double uniform = 0;        // where they are
    AlignedVector<T> squared;  // of every source, where they are not
  };
  // Which nodes of the targets and sources interact, and how; shared by engines with other widths. Found when a sum first needs them:
  // sources that are only asked at other targets need none of their own.
  struct Interactions {
    std::optional<InteractionLists> lists;
    std::vector<std::unique_ptr<M2lMatrices<T>>> matrices;  // of every order, made when it is needed
    std::shared_ptr<gpu::ListsOnDevice<T>> on_device;       // made when it is needed
  };

  // The targets of a leaf in blocks of cpu::kLanes; the last repeats the last point.
  struct Blocks {
    AlignedVector<T> x, y, z, width_squared, data;
  };

  // The same on the plan's device; false if it failed or there is none, and the processor has to do it.
  bool run_on_device(cpu::NearForm form, int batch, std::size_t out_channels, const Take& take);
  void resize(Blocks& blocks, std::size_t count, std::size_t data_channels) const;
  void place(const OctreeNode& leaf, std::size_t data_channels, Blocks& blocks) const;
  void set_terms(const M2lTerms& terms);
  const M2lMatrices<T>& make_matrices();  // of the current order
  [[nodiscard]] const M2lMatrices<T>& matrices() const { return *interactions_->matrices[static_cast<std::size_t>(terms_.order)]; }
  const InteractionLists& lists();
  void set_widths(const Widths& widths);
  [[nodiscard]] Places places_in(const Octree& tree, const std::vector<Vec3>& points) const;
  static std::size_t stride_of(std::size_t points) { return cpu::padded_count(points) + cpu::kLanes; }
  [[nodiscard]] std::size_t source_stride() const { return stride_of(sources_->count); }
  [[nodiscard]] std::size_t target_stride() const { return stride_of(target_tree_->nodes.front().count()); }
  void upward(cpu::NearForm form, int batch);
  // Moves between a node and its parent, by the node's octant.
  using MovesByOctant = std::array<std::vector<cpu::Translation<T>>, 8>;
  void translate_levels(cpu::NearForm form, const std::array<StoredTranslation<T>, 8>& matrices, const MovesByOctant& moves,
                        std::size_t channels) const;
  // Far pairs that share a matrix, by how their expansions move.
  struct Moves {
    std::vector<cpu::Translation<T>> all, forward, transposed;
  };
  std::size_t gather(cpu::NearForm form, const M2lMatrices<T>& matrices, std::size_t begin, std::size_t end, const FarPair*& pair,
                     T* locals, Moves& moves);
  // Local expansions of the far pairs of a part, by the slots of its nodes.
  void across(cpu::NearForm form, std::size_t part, T* locals);
  // From parents to some children. `at(node)`: where the local expansions of a node are.
  template <class At>
  void downward(cpu::NearForm form, const std::uint32_t* begin, const std::uint32_t* end, const At& at);
  AlignedVector<T> locals_above(cpu::NearForm form);
  void subtree(cpu::NearForm form, int batch, std::size_t out_channels, std::size_t part, AlignedVector<T>& above, const Take& take);
  // What the loop over the leaves of a block reuses.
  struct LeafSpace;
  void leaf(cpu::NearForm form, int batch, std::size_t out_channels, std::size_t number, const T* local, LeafSpace& space,
            const Take& take);
  cpu::LeafTask<T> leaf_task(cpu::NearForm form, int batch, double half_side) const;
  T* multipole(std::size_t node) { return multipoles_.data() + node * multipole_channels_ * stride_; }

  SumPlan plan_;
  bool local_widths_;
  const std::atomic<bool>* cancel_;
  std::shared_ptr<Sources> sources_;
  std::shared_ptr<SourceWidths> source_widths_;
  std::shared_ptr<Octree> target_tree_;  // the sources' tree when they are the targets
  Places target_places_;                 // of others
  std::shared_ptr<Interactions> interactions_;
  // Of the current run:
  M2lTerms terms_;
  std::size_t coefficients_ = 0;
  std::size_t stride_ = 0;              // of one expansion
  std::size_t multipole_channels_ = 0;  // expansions per node
  std::size_t local_channels_ = 0;
  std::size_t value_count_ = 0;
  AlignedVector<T> values_;                         // of the sources, one field after the other, source_stride() apart
  AlignedVector<T> target_values_;                  // the same of the targets
  std::shared_ptr<gpu::SumOnDevice<T>> on_device_;  // made when it is needed
  AlignedVector<T> multipoles_;
  std::optional<cpu::NearForm> multipoles_of_;  // the form for which they are those of the values
};

extern template class SumEngine<float>;
extern template class SumEngine<double>;

}  // namespace g3r
