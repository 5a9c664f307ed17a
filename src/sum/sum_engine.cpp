#include "sum/sum_engine.h"

#include "expansions/expansions.h"
#include "gpu/execution.h"
#include "gpu/sum_on_device.h"
#include "kernels/kernels.h"

#include <g3r/error.h>

#include <algorithm>
#include <chrono>

namespace g3r {
namespace {

constexpr int kLeastOrder = 2;          // with order 1 gradients would be constant in a cube
constexpr double kFewerTermsCut = 0.3;  // of the forms of one order less: at 1 they err by half more than the Stokeslets

std::size_t multipole_channels(cpu::NearForm form, int batch, bool local_widths) {
  switch (form) {
    case cpu::NearForm::kGreen:
    case cpu::NearForm::kGreenAdjoint:
      return static_cast<std::size_t>(batch);
    case cpu::NearForm::kStokesWinding:
      return cpu::kStokesMultipoles + (local_widths ? 1 : 0);
    case cpu::NearForm::kWinding:
    case cpu::NearForm::kWindingAdjoint:
    case cpu::NearForm::kWindingGradient:
      return 1;
  }
  return 0;
}

// What kernels are given of every target.
std::size_t target_fields(cpu::NearForm form, int batch) {
  return form == cpu::NearForm::kGreenAdjoint ? static_cast<std::size_t>(batch) : 0;
}

// Stokeslets multiply potentials by coordinates and need more terms than the other forms for the same error; measured over the clouds of
// fast_sum_test. An operator and its adjoint share the terms: kWindingAdjoint is that of the W in kStokesWinding too.
M2lTerms terms_for(cpu::NearForm form, int batch, const SumPlan& plan) {
  const bool green = form == cpu::NearForm::kGreen || form == cpu::NearForm::kGreenAdjoint;
  const bool fewer = form == cpu::NearForm::kWindingGradient || (green && batch > 1);
  if (!fewer || plan.order <= kLeastOrder) return {plan.order, plan.opening, plan.cut};
  return {plan.order - 1, plan.opening, kFewerTermsCut * plan.cut};
}

}  // namespace

template <class T>
void SumEngine<T>::set_targets(const std::vector<Vec3>& targets) {
  has_targets_there_ = false;
  geometry_.set_targets(targets);
}

template <class T>
void SumEngine<T>::begin_values(std::size_t values) {
  passes_.forget_multipoles();
  if (on_device_) on_device_->forget_values();
  value_count_ = values;
  if (values_.size() < values * geometry_.source_stride()) {
    values_ = AlignedVector<T>();  // not twice in memory
    values_.resize(values * geometry_.source_stride());
  }
}

template <class T>
std::shared_ptr<gpu::Execution> SumEngine<T>::execution() const {
  const std::shared_ptr<gpu::Execution>& execution = geometry_.plan().execution;
  return execution && execution->usable(sizeof(T) == sizeof(double)) ? execution : nullptr;
}

template <class T>
gpu::SumOnDevice<T>& SumEngine<T>::prepare_device(const M2lTerms& terms) {
  const SumPlan& plan = geometry_.plan();
  gpu::Device& device = plan.execution->device();
  const typename SumGeometry<T>::Sources& sources = geometry_.sources();
  const Octree& targets = geometry_.target_tree();
  std::shared_ptr<gpu::TreeOnDevice>& tree = geometry_.tree_on_device();
  if (!tree) tree = std::make_shared<gpu::TreeOnDevice>(device, sources.tree);
  std::shared_ptr<gpu::ListsOnDevice<T>>& lists = geometry_.lists_on_device();
  if (!lists) lists = std::make_shared<gpu::ListsOnDevice<T>>(device, targets, sources.tree, tree, geometry_.lists());
  lists->prepare_near();
  if (!plan.direct) {
    lists->prepare_far(geometry_.matrices(terms), terms.order, {sources.child_to_parent, sources.parent_to_child},
                       coefficient_count(plan.order));
  }
  if (!on_device_) {
    on_device_ =
        std::make_shared<gpu::SumOnDevice<T>>(device, gpu::SourcesOfSum<T>{sources.tree, sources.places.data(), geometry_.source_stride(),
                                                                           geometry_.squared_widths(), geometry_.uniform_width()});
    has_targets_there_ = false;
  }
  if (!has_targets_there_) {
    const T* const places = geometry_.has_own_targets() ? geometry_.target_places().data() : nullptr;
    on_device_->set_targets(lists, {targets.nodes.front().count(), places, geometry_.target_stride()});
    has_targets_there_ = true;
  }
  return *on_device_;
}

template <class T>
template <class Work>
void SumEngine<T>::in_parts(const std::atomic<bool>& taken, const Work& work) {
  for (;;) {
    try {
      return work();
    } catch (const gpu::OutOfMemory&) {
      const std::shared_ptr<gpu::ListsOnDevice<T>>& lists = geometry_.lists_on_device();
      if (taken || !lists || !lists->cut_finer()) throw;
    }
  }
}

template <class T>
const gpu::Buffer& SumEngine<T>::run_there(cpu::NearForm form, int batch, std::size_t values, std::size_t out_channels,
                                           const std::function<void(const gpu::Buffer&, const gpu::Buffer&)>& fill) {
  const M2lTerms terms = terms_for(form, batch, geometry_.plan());
  const cpu::SumRequest<T> request = request_for(form, batch, values, out_channels, terms);
  const std::atomic<bool> none_taken = false;
  in_parts(none_taken, [&] {
    gpu::SumOnDevice<T>& there = prepare_device(terms);
    (void)there.values(request);
    (void)there.target_data(request);
  });
  fill(on_device_->values(request), on_device_->target_data(request));  // once: it may read the sums that the next ones replace
  const gpu::Buffer* sums = nullptr;
  in_parts(none_taken, [&] { sums = &prepare_device(terms).sums_there(request); });
  return *sums;
}

template <class T>
bool SumEngine<T>::run_on_device(const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take) {
  const std::shared_ptr<gpu::Execution> execution = this->execution();
  if (!execution) return false;
  bool done = false;
  execution->device().alone([&] {
    if (execution->usable(sizeof(T) == sizeof(double))) done = run_alone(*execution, request, terms, take);  // else another thread's failed
  });
  return done;
}

template <class T>
bool SumEngine<T>::run_alone(gpu::Execution& execution, const cpu::SumRequest<T>& request, const M2lTerms& terms, const TakeSums& take) {
  std::atomic<bool> taken = false;
  const auto take_some = [&](std::size_t first, std::size_t count, const T* sums) {
    taken = true;
    std::vector<double> block(request.out_channels * cpu::kLanes);
    for (std::size_t done = 0; done < count; done += cpu::kLanes, sums += block.size()) {
      std::copy_n(sums, block.size(), block.begin());
      take(static_cast<std::uint32_t>(first + done), static_cast<std::uint32_t>(std::min(cpu::kLanes, count - done)), block.data());
    }
  };
  try {
    in_parts(taken, [&] {
      gpu::SumOnDevice<T>& there = prepare_device(terms);
      const auto start = std::chrono::steady_clock::now();
      there.run(request, take_some);
      execution.add_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    });
  } catch (const gpu::DeviceError& error) {
    on_device_.reset();
    geometry_.lists_on_device().reset();
    geometry_.tree_on_device().reset();
    execution.fail(error.what());
    if (taken) throw Unavailable(execution.failure() + ", while its results were read; --device cpu does without it");
    return false;
  }
  return true;
}

template <class T>
cpu::SumRequest<T> SumEngine<T>::request_for(cpu::NearForm form, int batch, std::size_t values, std::size_t out_channels,
                                             const M2lTerms& terms) const {
  const SumPlan& plan = geometry_.plan();
  const std::size_t channels = multipole_channels(form, batch, geometry_.local_widths());
  const bool stokes = form == cpu::NearForm::kStokesWinding;
  return {.form = form,
          .batch = batch,
          .direct = plan.direct,
          .order = terms.order,
          .reach = static_cast<T>(std::min(plan.reach, kMollifierReach<T>)),
          .kernel_error = plan.kernel_error,
          .values = values_.data(),
          .value_fields = values,
          .target_data = target_values_.data(),
          .data_fields = target_fields(form, batch),
          .multipole_channels = channels,
          .local_channels = channels + (stokes ? 1 : 0),
          .out_channels = out_channels,
          .cancel = cancel_};
}

template <class T>
void SumEngine<T>::run(cpu::NearForm form, int batch, std::size_t out_channels, const TakeSums& take) {
  const M2lTerms terms = terms_for(form, batch, geometry_.plan());
  const cpu::SumRequest<T> request = request_for(form, batch, value_count_, out_channels, terms);
  if (!run_on_device(request, terms, take)) passes_.run(geometry_, request, terms, take);
}

template class SumEngine<float>;
template class SumEngine<double>;

}  // namespace g3r
