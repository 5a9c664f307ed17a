// The passes of a sum on a device: the counterpart of sum/sum_passes.cpp, with the same lists, matrices and data.
// Internal to src/sum and src/gpu.
#pragma once

#include "cpu/sum_request.h"
#include "gpu/device.h"
#include "gpu/kernel_source.h"
#include "gpu/lists_on_device.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace g3r::gpu {

/// Sources: x, y and z relative to the centre of their leaf, one field after the other.
template <class T>
struct SourcesOfSum {
  const Octree& tree;
  const T* places;
  std::size_t stride;      ///< from one field to the next
  const T* squared_width;  ///< with local widths; null without
  double uniform_width;    ///< without local widths
};

/// Targets, in the same way.
template <class T>
struct TargetsOfSum {
  std::size_t count;
  const T* places;  ///< with local widths, their squares after z; null: the sources
  std::size_t stride;
};

/// Points on a device, and memory for their sums, allocated on first use. Throws DeviceError, Cancelled, std::bad_alloc.
template <class T>
class SumOnDevice {
 public:
  /// The device and the tree of the sources must outlive it.
  SumOnDevice(Device& device, const SourcesOfSum<T>& sources);

  /// Takes targets, in place of others; values of the sources stay, and so do their multipoles.
  void set_targets(std::shared_ptr<ListsOnDevice<T>> lists, const TargetsOfSum<T>& targets);
  /// The values of the sources are to change.
  void forget_values() { has_values_ = false; }

  /// take(first target, count, sums), for all targets: blocks of kLanes x out_channels, without 1/(4 pi).
  using Take = std::function<void(std::size_t first, std::size_t count, const T* sums)>;
  void run(const cpu::SumRequest<T>& request, const Take& take);

  /// Room for what a sum takes of the sources and of the targets, for the caller to fill.
  [[nodiscard]] const Buffer& values(const cpu::SumRequest<T>& request);
  [[nodiscard]] const Buffer& target_data(const cpu::SumRequest<T>& request);
  /// The same sums, which stay on the device until the next ones.
  const Buffer& sums_there(const cpu::SumRequest<T>& request);

 private:
  [[nodiscard]] KernelTraits traits(const cpu::SumRequest<T>& request) const;
  void upward(const cpu::SumRequest<T>& request, Program& expansions, Program& translations);
  void across(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets, Program& translations, Buffer& locals);
  void downward(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets, Program& translations, Buffer& locals);
  void near(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets);
  void far_to_points(const cpu::SumRequest<T>& request, const TargetsOnDevice& targets, Program& expansions, const Buffer& locals);
  template <class Launch>
  void in_slices(std::size_t count, std::size_t slice, const std::atomic<bool>* cancel, const Launch& launch);
  Buffer& room(std::unique_ptr<Buffer>& buffer, std::size_t elements);

  [[nodiscard]] const Buffer& target_geometry() const { return targets_ ? *targets_ : *sources_; }

  Device& device_;
  std::shared_ptr<ListsOnDevice<T>> lists_;
  const Octree& source_tree_;
  bool local_widths_;
  std::size_t source_stride_;
  std::size_t target_stride_ = 0;
  std::size_t target_count_ = 0;
  double uniform_width_;
  bool has_values_ = false;                     // those of the engine
  std::optional<cpu::NearForm> multipoles_of_;  // the form for which they are those of the values
  std::unique_ptr<Buffer> sources_, targets_;   // null: the sources
  std::unique_ptr<Buffer> values_, target_data_, multipoles_, out_;
};

extern template class SumOnDevice<float>;
extern template class SumOnDevice<double>;

}  // namespace g3r::gpu
