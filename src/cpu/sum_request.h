// One sum over a tree, as the passes take it: on the processor (sum/sum_passes.h) and on a device (gpu/sum_on_device.h).
#pragma once

#include "cpu/near_field.h"

#include <atomic>
#include <cstddef>

namespace g3r::cpu {

/// What is summed, to how many terms, of which values.
template <class T>
struct SumRequest {
  NearForm form;
  int batch;    ///< K
  bool direct;  ///< near field only
  int order;    ///< of the expansions
  T reach;      ///< as in NearTask
  double kernel_error;
  const T* values;  ///< of the sources, fields as their places
  std::size_t value_fields;
  const T* target_data;  ///< of the targets, fields as their places
  std::size_t data_fields;
  std::size_t multipole_channels;  ///< expansions per node
  std::size_t local_channels;
  std::size_t out_channels;
  const std::atomic<bool>* cancel;
};

}  // namespace g3r::cpu
