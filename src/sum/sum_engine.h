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
#include <cstddef>
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

/// The targets of a sum in blocks of cpu::kLanes, leaf by leaf; coordinates relative to the leaf's centre.
template <class T>
struct TargetBlocks {
  std::vector<std::size_t> first_block;  ///< of every leaf, and the total
  std::vector<std::uint32_t> point;      ///< of every lane; the tail of a leaf repeats its last point
  AlignedVector<T> x, y, z;
  AlignedVector<T> width_squared;  ///< only with local widths
};

/// Sums of one geometry in precision T. Memory is allocated on first use and reused. One caller at a time; parallel inside.
template <class T>
class SumEngine {
 public:
  using Points = std::shared_ptr<const std::vector<Vec3>>;

  /// Points in canonical order with their Morton codes; the sources are also the targets.
  SumEngine(Points points, const std::vector<std::uint64_t>& morton, const Widths& widths, const SumPlan& plan,
            const std::atomic<bool>* cancel);
  /// The same points with widths that are nowhere larger, in the tree and the lists of `other`, whose own targets are its sources.
  SumEngine(const SumEngine& other, const Widths& narrower);
  /// Another set of targets for the sources of `other` (uniform width), canonical order.
  SumEngine(const SumEngine& other, const std::vector<Vec3>& targets, const std::vector<std::uint64_t>& morton,
            const std::atomic<bool>* cancel);

  /// Takes other targets in place of those, canonical order; the values of the sources stay, and so does what was made of them.
  void set_targets(const std::vector<Vec3>& targets, const std::vector<std::uint64_t>& morton);

  [[nodiscard]] bool local_widths() const { return local_widths_; }
  [[nodiscard]] const TargetBlocks<T>& targets();

  /// Makes room for `values` values per source, for the caller to fill: the k-th of source i is value(k)[i].
  void begin_values(std::size_t values);
  [[nodiscard]] T* value(std::size_t k) { return fields_.data() + (geometry_fields() + k) * field_stride(); }
  /// Target data: blocks x channels x lanes for the caller to fill.
  AlignedVector<T>& target_data(std::size_t channels);

  /// Runs a form over the values and target_data(): result is blocks x out_channels x lanes, without 1/(4 pi).
  const std::vector<double>& run(cpu::NearForm form, int batch, std::size_t out_channels);

 private:
  // What belongs to the sources, shared by engines with other targets or widths.
  struct Sources {
    Points points;
    Octree tree;                                          // its nodes know the widest widths
    std::array<StoredTranslation<T>, 8> child_to_parent;  // M2M by octant
    std::array<StoredTranslation<T>, 8> parent_to_child;  // L2L by octant
  };
  // Shared by engines with other targets.
  struct SourceFields {
    std::vector<double> widths;
    AlignedVector<T> geometry;  // x, y, z relative to the leaf's centre, and the squared width with local widths: fields as in fields_
  };
  // Which nodes of the targets and sources interact, and how; shared by engines with other widths. Found when a sum first needs them:
  // sources that are only asked at other targets need none of their own.
  struct Interactions {
    std::optional<InteractionLists> lists;
    std::vector<std::unique_ptr<M2lMatrices<T>>> matrices;  // of every order, made when it is needed
    std::shared_ptr<gpu::ListsOnDevice<T>> on_device;       // made when it is needed
  };

  // The same on the plan's device; false if it failed or there is none, and the processor has to do it.
  bool run_on_device(cpu::NearForm form, int batch, std::size_t out_channels);
  void set_terms(const M2lTerms& terms);
  const M2lMatrices<T>& matrices();  // of the current order
  void locate_sources(const std::vector<double>& widths);
  void locate_targets(const std::vector<Vec3>& targets, const std::vector<double>& target_widths);
  const InteractionLists& lists();
  // x, y, z and, with local widths, the squared width.
  [[nodiscard]] std::size_t geometry_fields() const { return local_widths_ ? 4 : 3; }
  [[nodiscard]] std::size_t field_stride() const { return cpu::padded_count(sources_->points->size()) + cpu::kLanes; }
  void upward(cpu::NearForm form, int batch);
  // Moves between a node and its parent, by the node's octant.
  using MovesByOctant = std::array<std::vector<cpu::Translation<T>>, 8>;
  void translate_levels(cpu::NearForm form, const std::array<StoredTranslation<T>, 8>& matrices, const MovesByOctant& moves,
                        std::size_t channels) const;
  // Far pairs that share a matrix, by how their expansions move.
  struct Moves {
    std::vector<cpu::Translation<T>> all, forward, transposed;
  };
  void across(cpu::NearForm form);
  std::size_t gather(cpu::NearForm form, const M2lMatrices<T>& matrices, std::size_t begin, std::size_t end, Moves& moves);
  void downward(cpu::NearForm form);
  void leaves(cpu::NearForm form, int batch, std::size_t out_channels);
  cpu::LeafTask<T> leaf_task(cpu::NearForm form, int batch, double half_side) const;
  T* multipole(std::size_t node) { return multipoles_.data() + node * multipole_channels_ * stride_; }
  T* local(std::size_t node) { return locals_.data() + node * local_channels_ * stride_; }

  SumPlan plan_;
  bool local_widths_;
  const std::atomic<bool>* cancel_;
  std::shared_ptr<Sources> sources_;
  std::shared_ptr<SourceFields> source_fields_;
  std::shared_ptr<Octree> target_tree_;       // the sources' tree when they are the targets
  std::shared_ptr<TargetBlocks<T>> targets_;  // null: the sources, not yet located
  std::shared_ptr<Interactions> interactions_;
  // Of the current run:
  M2lTerms terms_;
  std::size_t coefficients_ = 0;
  std::size_t stride_ = 0;              // of one expansion
  std::size_t multipole_channels_ = 0;  // expansions per node
  std::size_t local_channels_ = 0;
  AlignedVector<T> fields_;  // geometry and values of the sources, one field after the other, field_stride() apart
  std::size_t field_count_ = 0;
  AlignedVector<T> target_data_;
  std::shared_ptr<gpu::SumOnDevice<T>> on_device_;  // made when it is needed
  AlignedVector<T> multipoles_;
  std::optional<cpu::NearForm> multipoles_of_;  // the form for which they are those of the values
  AlignedVector<T> locals_;
  std::vector<double> out_;
};

extern template class SumEngine<float>;
extern template class SumEngine<double>;

}  // namespace g3r
