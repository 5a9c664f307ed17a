// The passes of a sum on a device: the counterpart of the loops in sum/sum_engine.cpp, with the same lists, matrices and data.
// Internal to src/sum and src/gpu.
#pragma once

#include "cpu/near_field.h"
#include "gpu/device.h"
#include "gpu/kernel_source.h"
#include "gpu/lists_on_device.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace g3r::gpu {

/// Sources and targets of an engine, in the layout of cpu::NearTask.
template <class T>
struct PointsOfSum {
  const T* places;                              ///< x, y and z of the sources
  const T* source_width_squared;                ///< with local widths
  std::size_t field_stride;                     ///< from one field to the next
  const std::vector<std::size_t>& first_block;  ///< of every target leaf, and the total
  const T* x;                                   ///< of the targets
  const T* y;
  const T* z;
  const T* width_squared;  ///< with local widths
  double uniform_width;    ///< without
};

/// One sum: what, to how many terms, of which values.
template <class T>
struct SumRequest {
  cpu::NearForm form;
  int batch;    ///< K
  bool direct;  ///< near field only
  int order;
  T reach;  ///< as in cpu::NearTask
  double kernel_error;
  const T* values;  ///< fields as in places
  std::size_t value_fields;
  const T* target_data;  ///< blocks x channels x kLanes
  std::size_t data_channels;
  std::size_t multipole_channels;
  std::size_t local_channels;
  std::size_t out_channels;
  const std::atomic<bool>* cancel;
};

/// Points on a device, and memory for their sums, allocated on first use. Throws DeviceError, Cancelled, std::bad_alloc.
template <class T>
class SumOnDevice {
 public:
  /// The device and the lists must outlive it, as must the trees.
  SumOnDevice(Device& device, const ListsOnDevice<T>& lists, const Octree& targets, const Octree& sources, const PointsOfSum<T>& points);

  /// Target blocks x out_channels x kLanes into `out`, without 1/(4 pi); lanes that repeat a target are not defined.
  void run(const SumRequest<T>& request, std::vector<double>& out);

 private:
  [[nodiscard]] KernelTraits traits(const SumRequest<T>& request) const;
  void upward(const SumRequest<T>& request, Program& expansions, Program& translations);
  void across(const SumRequest<T>& request, Program& translations);
  void downward(const SumRequest<T>& request, Program& translations);
  void near(const SumRequest<T>& request);
  void far_to_points(const SumRequest<T>& request, Program& expansions);
  template <class Launch>
  void in_slices(std::size_t count, std::size_t slice, const std::atomic<bool>* cancel, const Launch& launch);
  Buffer& room(std::unique_ptr<Buffer>& buffer, std::size_t elements);

  Device& device_;
  const ListsOnDevice<T>& lists_;
  const Octree& target_tree_;
  const Octree& source_tree_;
  std::size_t field_stride_;
  std::size_t geometry_fields_;
  std::size_t lanes_;  // of the targets
  double uniform_width_;
  AlignedVector<T> geometry_;              // until the fields have room
  std::unique_ptr<Buffer> target_leaves_;  // uint2 of every leaf: first block, points
  std::unique_ptr<Buffer> x_, y_, z_, width_squared_;
  std::unique_ptr<Buffer> fields_, target_data_, multipoles_, locals_, out_;
  std::vector<T> staged_;
};

extern template class SumOnDevice<float>;
extern template class SumOnDevice<double>;

}  // namespace g3r::gpu
