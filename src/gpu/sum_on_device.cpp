#include "gpu/sum_on_device.h"

#include "cpu/parallel.h"
#include "kernels/expansion_index.h"
#include "kernels/kernel_polynomials.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace g3r::gpu {
namespace {

// Leaves and chunks of one launch: between launches a sum can be cancelled, and a screen drawn by the same device refreshed.
constexpr std::size_t kSlice = 1u << 17;
constexpr std::size_t kSoftwareSlice = 256;
constexpr std::size_t kSharedBytes = 32u << 10;  // of local memory, which every device in use has
constexpr std::size_t kMostSlots = 4;            // pairs of a tile at a time
constexpr std::size_t kTakenBlocks = 64;         // of results, that a thread takes at a time
// Of a tile of points_to_multipoles(). On a GPU its local memory decides how many groups run at a time; processors want few tiles.
constexpr std::size_t kMostPoints = 16;
constexpr std::size_t kSoftwareMostPoints = 32;

// Of points_to_multipoles(): work-groups of a leaf, and sums of each.
struct UpShape {
  std::size_t groups;  // UP_PARTS / TOGETHER there
  std::size_t sums;    // TOGETHER * EACH
};
UpShape up_shape(const KernelTraits& traits) {
  using enum cpu::NearForm;
  const bool green = traits.form == kGreen || traits.form == kGreenAdjoint;
  const auto batch = static_cast<std::size_t>(traits.batch);
  const std::size_t of_stokes = traits.local_widths ? 5 : 4;
  const std::size_t parts = green ? batch : traits.form == kStokesWinding ? of_stokes : 1;
  const std::size_t together = traits.doubles ? 1 : green && batch % 3 == 0 ? 3 : parts;
  const std::size_t each = traits.form == kGreenAdjoint || traits.form == kWindingAdjoint ? 1
                           : traits.form == kGreen || traits.form == kStokesWinding       ? 4
                                                                                          : 3;
  return {parts / together, together * each};
}

// Of locals_to_points(): ROWS there.
std::size_t down_rows(const KernelTraits& traits) {
  using enum cpu::NearForm;
  if (traits.form == kStokesWinding) return traits.local_widths ? 10 : 9;
  return traits.form == kGreen || traits.form == kGreenAdjoint ? static_cast<std::size_t>(traits.batch) : 1;
}

// Expansions that the moves of M2L take at most: MOST_MOVED there.
std::size_t most_moved(cpu::NearForm form, std::size_t multipole_channels, bool local_widths) {
  return form == cpu::NearForm::kStokesWinding ? (local_widths ? 6 : 5) : multipole_channels;
}

// From a pair to the next in the local memory of multipoles_to_locals(): SLOT there.
std::size_t packed_slot(std::size_t moved, std::size_t stride) { return stride * (moved > 1 ? (moved + 3) / 4 * 4 : 1) + 8; }

// The largest power of two up to `most` with which `fixed` + count * each numbers fit the local memory; at least `least`.
std::size_t that_fit(std::size_t most, std::size_t least, std::size_t fixed, std::size_t each, std::size_t bytes_of_one) {
  std::size_t count = most;
  while (count > least && (fixed + count * each) * bytes_of_one > kSharedBytes) count /= 2;
  return count;
}

}  // namespace

template <class T>
SumOnDevice<T>::SumOnDevice(Device& device, const SourcesOfSum<T>& sources)
    : device_(device),
      source_tree_(sources.tree),
      local_widths_(sources.squared_width != nullptr),
      source_stride_(sources.stride),
      uniform_width_(sources.uniform_width) {
  const std::size_t bytes = 3 * source_stride_ * sizeof(T);
  const std::size_t of_widths = local_widths_ ? source_stride_ * sizeof(T) : 0;
  sources_ = device.allocate(bytes + of_widths);
  device.write(*sources_, 0, sources.places, bytes);
  device.write(*sources_, bytes, sources.squared_width, of_widths);
}

template <class T>
void SumOnDevice<T>::set_targets(std::shared_ptr<ListsOnDevice<T>> lists, const TargetsOfSum<T>& targets) {
  lists_ = std::move(lists);
  target_count_ = targets.count;
  target_stride_ = targets.stride;
  if (targets.places == nullptr) return;
  const std::size_t elements = (local_widths_ ? 4 : 3) * target_stride_;
  device_.write(room(targets_, elements), 0, targets.places, elements * sizeof(T));
}

template <class T>
Buffer& SumOnDevice<T>::room(std::unique_ptr<Buffer>& buffer, std::size_t elements) {
  const std::size_t bytes = elements * sizeof(T);
  if (!buffer || buffer->bytes() < bytes) {
    buffer.reset();  // not twice in memory
    buffer = device_.allocate(bytes);
  }
  return *buffer;
}

template <class T>
KernelTraits SumOnDevice<T>::traits(const cpu::SumRequest<T>& request) const {
  KernelTraits traits;
  traits.form = request.form;
  traits.batch = request.batch;
  traits.local_widths = local_widths_;
  traits.doubles = sizeof(T) == sizeof(double);
  traits.rough = !traits.doubles && request.kernel_error >= kRoughPolynomialError;
  traits.lanes = traits.doubles ? device_.info().lanes_double : device_.info().lanes_float;
  return traits;
}

// launch(first, number) over [0, count).
template <class T>
template <class Launch>
void SumOnDevice<T>::in_slices(std::size_t count, std::size_t slice, const std::atomic<bool>* cancel, const Launch& launch) {
  for (std::size_t first = 0; first < count; first += slice) {
    if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
    launch(first, std::min(slice, count - first));
    if (first + slice < count) device_.finish();
  }
}

template <class T>
void SumOnDevice<T>::upward(const cpu::SumRequest<T>& request, Program& expansions, Program& translations) {
  const KernelTraits t = traits(request);
  const TreeOnDevice& tree = lists_->sources();
  const std::size_t n = coefficient_count(request.order);
  const std::size_t stride = cpu::padded_count(n);
  const UpShape shape = up_shape(t);
  Buffer& multipoles = room(multipoles_, source_tree_.nodes.size() * request.multipole_channels * stride);
  const std::size_t most_points = device_.info().software ? kSoftwareMostPoints : kMostPoints;
  const std::size_t fixed = n * (3 + shape.sums);
  const std::size_t each = n + 3 + shape.sums;
  const std::size_t points = that_fit(most_points, t.lanes, fixed, each, sizeof(T));
  const std::size_t slice = device_.info().software ? kSoftwareSlice : kSlice;
  in_slices(source_tree_.leaves.size(), slice, request.cancel, [&](std::size_t first, std::size_t number) {
    device_.launch(expansions.kernel("points_to_multipoles"), number * shape.groups, far_group(t),
                   {as_int(first), *tree.leaf_points, *tree.leaf_nodes, *tree.leaf_centres, *sources_, *values_, narrow(source_stride_),
                    request.order, as_int(stride), as_int(points), multipoles},
                   (fixed + points * each) * sizeof(T));
  });
  const MatricesOnDevice& shifts = lists_->child_to_parent();
  const std::size_t apart = shifts.groups->bytes() / sizeof(std::array<std::uint32_t, 4>) / 8;
  for (std::size_t level = source_tree_.levels(); level-- > 0;) {
    const std::size_t first = source_tree_.level_begin[level];
    device_.launch(translations.kernel("multipoles_to_parents"), source_tree_.level_begin[level + 1] - first, far_group(t),
                   {as_int(first), *tree.children, *tree.octants, *tree.centres, *shifts.data, *shifts.groups, as_int(apart), as_int(n),
                    as_int(stride), multipoles},
                   request.multipole_channels * stride * sizeof(T));
  }
}

template <class T>
void SumOnDevice<T>::across(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets, Program& translations, Buffer& locals) {
  const KernelTraits t = traits(request);
  const std::size_t stride = cpu::padded_count(coefficient_count(request.order));
  const std::size_t moved = most_moved(request.form, request.multipole_channels, t.local_widths);
  const MatricesOnDevice& matrices = lists_->matrices(request.order);
  const std::size_t each = packed_slot(moved, stride);
  const std::size_t slots = that_fit(kMostSlots, 1, 0, each, sizeof(T));
  const std::size_t slice = std::max<std::size_t>(1, (device_.info().software ? kSoftwareSlice : kSlice) / 8);
  in_slices(targets.chunks, slice, request.cancel, [&](std::size_t first, std::size_t number) {
    device_.launch(translations.kernel("multipoles_to_locals"), number, far_group(t),
                   {as_int(first), as_int(targets.chunk_nodes), as_int(targets.nodes), *targets.chunk_tiles, *targets.tiles, *targets.pairs,
                    *lists_->sources().centres, *targets.tree->centres, *matrices.signs, *matrices.data, *matrices.groups, *matrices.shapes,
                    as_int(stride), as_int(slots), *multipoles_, locals},
                   slots * each * sizeof(T));
  });
}

template <class T>
void SumOnDevice<T>::downward(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets, Program& translations, Buffer& locals) {
  const KernelTraits t = traits(request);
  const TreeOnDevice& tree = *targets.tree;
  const std::size_t n = coefficient_count(request.order);
  const std::size_t stride = cpu::padded_count(n);
  const MatricesOnDevice& shifts = lists_->parent_to_child();
  const std::size_t apart = shifts.groups->bytes() / sizeof(std::array<std::uint32_t, 4>) / 8;
  for (std::size_t level = 1; level + 1 < targets.level_begin.size(); ++level) {
    const std::size_t first = targets.level_begin[level];
    device_.launch(translations.kernel("locals_to_children"), targets.level_begin[level + 1] - first, far_group(t),
                   {as_int(first), *tree.parents, *tree.octants, *tree.centres, *shifts.data, *shifts.groups, as_int(apart), as_int(n),
                    as_int(stride), locals},
                   request.local_channels * stride * sizeof(T));
  }
}

template <class T>
void SumOnDevice<T>::near(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets) {
  const KernelTraits t = traits(request);
  Program& program = device_.program(near_field_source(t));
  const T width2 = static_cast<T>(uniform_width_ * uniform_width_);
  const T inverse_width = static_cast<T>(1 / uniform_width_);
  const T reach2 = request.reach * request.reach;
  const std::size_t slice = device_.info().software ? kSoftwareSlice : kSlice;
  in_slices(targets.leaves, slice, request.cancel, [&](std::size_t first, std::size_t number) {
    device_.launch(
        program.kernel("near_field"), number, near_group(t),
        {as_int(first), *targets.near_order, *targets.near_begin, *targets.near_leaves, *targets.near_points, *targets.tree->leaf_points,
         *targets.tree->leaf_centres, *lists_->sources().leaf_points, *lists_->sources().leaf_centres, *sources_, *values_,
         narrow(source_stride_), target_geometry(), *target_data_, narrow(target_stride_), width2, inverse_width, reach2, *out_},
        0);
  });
}

template <class T>
void SumOnDevice<T>::far_to_points(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets, Program& expansions,
                                   const Buffer& locals) {
  const KernelTraits t = traits(request);
  const std::size_t n = coefficient_count(request.order);
  const T width2 = static_cast<T>(uniform_width_ * uniform_width_);
  const std::size_t slice = device_.info().software ? kSoftwareSlice : kSlice;
  const TreeOnDevice& tree = *targets.tree;
  in_slices(targets.leaves, slice, request.cancel, [&](std::size_t first, std::size_t number) {
    device_.launch(expansions.kernel("locals_to_points"), number, far_group(t),
                   {as_int(first), *tree.leaf_points, *tree.leaf_nodes, *tree.leaf_centres, target_geometry(), *target_data_,
                    narrow(target_stride_), request.order, as_int(cpu::padded_count(n)), width2, locals, *out_},
                   n * (down_rows(t) + 2) * sizeof(T));
  });
}

template <class T>
const Buffer& SumOnDevice<T>::values(const cpu::SumRequest<T>& request) {
  forget_values();
  multipoles_of_.reset();
  return room(values_, request.value_fields * source_stride_);
}

template <class T>
const Buffer& SumOnDevice<T>::target_data(const cpu::SumRequest<T>& request) {
  return room(target_data_, request.data_fields * target_stride_);
}

template <class T>
const Buffer& SumOnDevice<T>::sums_there(const cpu::SumRequest<T>& request) {
  room(out_, (target_count_ + cpu::kLanes - 1) / cpu::kLanes * request.out_channels * cpu::kLanes);
  if (request.direct) {
    for (const TargetsOnDevice& targets : lists_->parts()) near(request, targets);
    return *out_;
  }
  Program& expansions = device_.program(expansions_source(traits(request)));
  Program& translations = device_.program(translations_source(traits(request)));
  Buffer& locals = lists_->locals(request.local_channels * cpu::padded_count(coefficient_count(request.order)));
  if (multipoles_of_ != request.form) {
    multipoles_of_.reset();
    upward(request, expansions, translations);
    multipoles_of_ = request.form;
  }
  for (const TargetsOnDevice& targets : lists_->parts()) {
    near(request, targets);
    across(request, targets, translations, locals);
    downward(request, targets, translations, locals);
    far_to_points(request, targets, expansions, locals);
  }
  return *out_;
}

template <class T>
void SumOnDevice<T>::run(const cpu::SumRequest<T>& request, const Take& take) {
  if (!has_values_) device_.write(values(request), 0, request.values, request.value_fields * source_stride_ * sizeof(T));
  has_values_ = true;
  device_.write(target_data(request), 0, request.target_data, request.data_fields * target_stride_ * sizeof(T));
  const Buffer& sums = sums_there(request);
  const std::size_t block = request.out_channels * cpu::kLanes;
  const std::size_t elements = (target_count_ + cpu::kLanes - 1) / cpu::kLanes * block;
  device_.finish();  // what fails, fails before anything is taken
  device_.read(sums, elements * sizeof(T), block * sizeof(T), [&](std::size_t offset, const unsigned char* data, std::size_t bytes) {
    const std::size_t first_block = offset / (block * sizeof(T));
    const auto* const sums = reinterpret_cast<const T*>(data);
    parallel::for_blocks(bytes / (block * sizeof(T)), kTakenBlocks, [&](std::size_t begin, std::size_t end) {
      const std::size_t first = (first_block + begin) * cpu::kLanes;
      take(first, std::min((first_block + end) * cpu::kLanes, target_count_) - first, sums + begin * block);
    });
  });
}

template class SumOnDevice<float>;
template class SumOnDevice<double>;

}  // namespace g3r::gpu
