// The engine behind every sum: the values of the sources, and where sums run. Internal to src/sum.
#pragma once

#include "cpu/aligned_vector.h"
#include "cpu/near_field.h"
#include "sum/sum_geometry.h"
#include "sum/sum_passes.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace g3r::gpu {
class Buffer;
class Execution;
template <class T>
class SumOnDevice;
}  // namespace g3r::gpu

namespace g3r {

/// Sums of one geometry in precision T. What a sum holds for every source is allocated on first use and reused; what it holds for targets
/// is made part by part of their tree. One caller at a time; parallel inside.
template <class T>
class SumEngine {
 public:
  /// The constructors of SumGeometry. `cancel` may be null.
  SumEngine(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel)
      : geometry_(points, widths, plan), cancel_(cancel) {}
  SumEngine(const SumEngine& other, const Widths& narrower) : geometry_(other.geometry_, narrower), cancel_(other.cancel_) {}
  SumEngine(const SumEngine& other, const std::vector<Vec3>& targets, const std::atomic<bool>* cancel)
      : geometry_(other.geometry_, targets), cancel_(cancel) {}

  /// Of the kernel of this source.
  [[nodiscard]] double source_width(std::size_t source) const { return geometry_.source_width(source); }

  /// Takes other targets in place of those, canonical order; the values of the sources stay, and so does what was made of them.
  void set_targets(const std::vector<Vec3>& targets);

  /// Makes room for `values` values per source, for the caller to fill: the k-th of source i is value(k)[i].
  void begin_values(std::size_t values);
  [[nodiscard]] T* value(std::size_t k) { return values_.data() + k * geometry_.source_stride(); }
  /// The same of `values` values per target, which are the sources.
  void begin_target_values(std::size_t values) { target_values_.resize(values * geometry_.source_stride()); }
  [[nodiscard]] T* target_value(std::size_t k) { return target_values_.data() + k * geometry_.source_stride(); }

  /// Runs a form over the values; sums are without 1/(4 pi).
  void run(cpu::NearForm form, int batch, std::size_t out_channels, const TakeSums& take);

  /// The device that sums run on, null where that is the processor.
  [[nodiscard]] std::shared_ptr<gpu::Execution> execution() const;
  /// Runs a form of `values` values per source on that device, where the sums stay until the next ones. fill(values, those of the targets)
  /// puts them there, fields source_stride() apart. Within alone() of the device. Throws DeviceError.
  const gpu::Buffer& run_there(cpu::NearForm form, int batch, std::size_t values, std::size_t out_channels,
                               const std::function<void(const gpu::Buffer&, const gpu::Buffer&)>& fill);
  [[nodiscard]] std::size_t source_stride() const { return geometry_.source_stride(); }

 private:
  [[nodiscard]] cpu::SumRequest<T> request_for(cpu::NearForm form, int batch, std::size_t values, std::size_t out_channels,
                                               const M2lTerms& terms) const;
  // False if there is no device, or it failed, and the processor has to do it.
  bool run_on_device(const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take);
  bool run_alone(gpu::Execution& execution, const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take);
  // Does work(), again with the targets in more parts while it runs out of the device's memory before any sum is taken.
  template <class Work>
  void in_parts(const std::atomic<bool>& taken, const Work& work);
  // What sums with these terms need there, uploaded unless it is there.
  gpu::SumOnDevice<T>& prepare_device(const M2lTerms& terms);

  SumGeometry<T> geometry_;
  const std::atomic<bool>* cancel_;
  std::size_t value_count_ = 0;
  AlignedVector<T> values_;         // of the sources, one field after the other, source_stride() apart
  AlignedVector<T> target_values_;  // the same of the targets
  SumPasses<T> passes_;
  std::shared_ptr<gpu::SumOnDevice<T>> on_device_;  // made when it is needed
  bool has_targets_there_ = false;                  // those of the geometry
};

extern template class SumEngine<float>;
extern template class SumEngine<double>;

}  // namespace g3r
