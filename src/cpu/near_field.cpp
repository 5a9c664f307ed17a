// The near field: exact pair sums. Highway compiles this file once per instruction set.
//
// The sources of a task are gathered into one array per field, so that vectors are full whatever the sizes of the leaves they come from.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/near_field.cpp"
#include "cpu/near_field.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "cpu/near_forms.h"  // NOLINT(llvm-include-order): anew for every instruction set

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

// The sources of a task, run after run, in pieces of gathered_sources(): field f of the i-th at workspace[f * kStride + i]. The first
// kGeometry fields say where and how wide they are.
template <class T, std::size_t kGeometry, std::size_t kFields>
class Gathering {
 public:
  static constexpr std::size_t kMost = gathered_sources(kFields);
  static constexpr std::size_t kStride = kMost + kLanes;

  explicit Gathering(const NearTask<T>& task) : task_(task) {
    for (std::size_t f = 0; f < 3; ++f) from_[f] = task.places + f * task.stride;
    if constexpr (kGeometry > 3) from_[3] = task.source_width_squared;
    for (std::size_t f = kGeometry; f < kFields; ++f) from_[f] = task.values + (f - kGeometry) * task.stride;
  }

  // Gathers the next piece, padded to whole vectors by sources without any value. Returns its padded size, 0 when there are none left.
  // Not a part of every form's code: that would take a third of the time to compile this file.
  HWY_NOINLINE std::size_t next() {
    const Tag<T> d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t size = 0;
    while (run_ < task_.run_count && size < kMost) {
      const SourceRun<T>& run = task_.runs[run_];
      const std::size_t count = HWY_MIN(run.count - done_, kMost - size);
      const std::size_t first = run.begin + done_;
      T* to = task_.workspace + size;
      const Vec<T> shift[3] = {hn::Set(d, run.shift[0]), hn::Set(d, run.shift[1]), hn::Set(d, run.shift[2])};
      for (std::size_t i = 0; i < count; i += lanes) {
        HWY_UNROLL(3)
        for (std::size_t f = 0; f < 3; ++f) hn::StoreU(hn::Add(hn::LoadU(d, from_[f] + first + i), shift[f]), d, to + f * kStride + i);
        HWY_UNROLL(kMostFields)
        for (std::size_t f = 3; f < kFields; ++f) hn::StoreU(hn::LoadU(d, from_[f] + first + i), d, to + f * kStride + i);
      }
      size += count;
      done_ += count;
      if (done_ < run.count) continue;
      ++run_;
      done_ = 0;
    }
    if (size == 0) return 0;
    const std::size_t padded = (size + lanes - 1) / lanes * lanes;
    for (std::size_t f = 0; f < kFields; ++f) {
      T* field = task_.workspace + f * kStride;
      const T pad = f < kGeometry ? field[size - 1] : T{0};
      for (std::size_t i = size; i < padded; ++i) field[i] = pad;
    }
    return padded;
  }

 private:
  const NearTask<T>& task_;
  const T* from_[kFields];
  std::size_t run_ = 0;
  std::size_t done_ = 0;  // sources of that run
};

template <class T, class Form, bool kLocalWidths, Precision kPrecision>
void Run(const NearTask<T>& task) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  constexpr std::size_t kChannels = Form::kChannels;
  constexpr std::size_t kTargetData = Form::kTargetData;
  constexpr std::size_t kFirstField = kLocalWidths ? 4 : 3;
  using Sources = Gathering<T, kFirstField, kFirstField + Form::kFields>;
  constexpr std::size_t stride = Sources::kStride;
  const T* source = task.workspace;
  const Vec<T> reach2 = hn::Set(d, task.reach * task.reach);
  Vec<T> inverse_width = ReciprocalSqrt<T, Precision::kFull>(hn::Set(d, task.uniform_width_squared));
  const std::size_t blocks = (task.count + kLanes - 1) / kLanes;
  for (std::size_t i = 0; i < blocks * kChannels * kLanes; ++i) task.out[i] = 0;
  Sources gathering(task);
  for (std::size_t size = gathering.next(); size > 0; size = gathering.next()) {
    for (std::size_t t = 0; t < task.count; ++t) {
      const std::size_t block = t / kLanes;
      const std::size_t lane = t % kLanes;
      const Vec<T> x = hn::Set(d, task.x[t]);
      const Vec<T> y = hn::Set(d, task.y[t]);
      const Vec<T> z = hn::Set(d, task.z[t]);
      const Vec<T> half_width_squared = hn::Set(d, kLocalWidths ? T{0.5} * task.width_squared[t] : T{0});
      Vec<T> u[kTargetData + 1];
      for (std::size_t c = 0; c < kTargetData; ++c) u[c] = hn::Set(d, task.u[(block * kTargetData + c) * kLanes + lane]);
      Vec<T> sum[kChannels];
      for (std::size_t c = 0; c < kChannels; ++c) sum[c] = hn::Zero(d);
      for (std::size_t s = 0; s < size; s += lanes) {
        const Difference<T> r{hn::Sub(hn::Load(d, source + s), x), hn::Sub(hn::Load(d, source + stride + s), y),
                              hn::Sub(hn::Load(d, source + 2 * stride + s), z)};
        const Vec<T> r2 = r.Dot(r.x, r.y, r.z);
        Vec<T> width_squared = hn::Set(d, task.uniform_width_squared);
        if constexpr (kLocalWidths) {
          width_squared = hn::MulAdd(hn::Set(d, T{0.5}), hn::Load(d, source + 3 * stride + s), half_width_squared);
        }
        Kernel<T> k = PlainKernel<T, Form::kValue, Form::kThird>(ReciprocalSqrt<T, kPrecision>(r2), width_squared);
        const auto near = hn::Lt(r2, hn::Mul(reach2, width_squared));
        if (HWY_UNLIKELY(!hn::AllFalse(d, near))) {
          if constexpr (kLocalWidths) inverse_width = ReciprocalSqrt<T, Precision::kFull>(width_squared);
          const Kernel<T> m = MollifiedKernel<T, kPrecision, Form::kValue, Form::kThird>(r2, width_squared, inverse_width);
          k.flux = hn::IfThenElse(near, m.flux, k.flux);
          if constexpr (Form::kValue) k.value = hn::IfThenElse(near, m.value, k.value);
          if constexpr (Form::kThird != Third::kNone) k.third = hn::IfThenElse(near, m.third, k.third);
        }
        Form::Add({source + kFirstField * stride + s, stride}, r, k, u, sum);
      }
      double* out = task.out + block * kChannels * kLanes + lane;
      for (std::size_t c = 0; c < kChannels; ++c) out[c * kLanes] += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum[c])));
    }
  }
}

template <class T, class Form, bool kLocalWidths>
void RunPrecision(const NearTask<T>& task) {
  if constexpr (sizeof(T) == 4) {
    if (task.kernel_error >= kRoughError) return Run<T, Form, kLocalWidths, Precision::kRough>(task);
  }
  Run<T, Form, kLocalWidths, Precision::kFull>(task);
}

template <class T, class Form>
void RunWidths(const NearTask<T>& task) {
  if (task.local_widths) {
    RunPrecision<T, Form, true>(task);
  } else {
    RunPrecision<T, Form, false>(task);
  }
}

template <class T, template <class, int> class Form>
void RunBatch(const NearTask<T>& task) {
  switch (task.batch) {
    case 1:
      return RunWidths<T, Form<T, 1>>(task);
    case 4:
      return RunWidths<T, Form<T, 4>>(task);
    default:
      return RunWidths<T, Form<T, 9>>(task);
  }
}

template <class T>
void RunForm(const NearTask<T>& task) {
  switch (task.form) {
    case NearForm::kGreen:
      return RunBatch<T, GreenForm>(task);
    case NearForm::kGreenAdjoint:
      return RunBatch<T, GreenAdjointForm>(task);
    case NearForm::kStokesWinding:
      return RunWidths<T, StokesWindingForm<T>>(task);
    case NearForm::kWinding:
      return RunWidths<T, WindingForm<T>>(task);
    case NearForm::kWindingAdjoint:
      return RunWidths<T, WindingAdjointForm<T>>(task);
    case NearForm::kWindingGradient:
      return RunWidths<T, WindingGradientForm<T>>(task);
  }
}

void NearFieldFloat(const NearTask<float>& task) { RunForm(task); }
void NearFieldDouble(const NearTask<double>& task) { RunForm(task); }
const char* InstructionSet() { return hwy::TargetName(HWY_TARGET); }

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace g3r::cpu {

HWY_EXPORT(NearFieldFloat);
HWY_EXPORT(NearFieldDouble);
HWY_EXPORT(InstructionSet);

void near_field(const NearTask<float>& task) { HWY_DYNAMIC_DISPATCH(NearFieldFloat)(task); }
void near_field(const NearTask<double>& task) { HWY_DYNAMIC_DISPATCH(NearFieldDouble)(task); }
const char* instruction_set() { return HWY_DYNAMIC_DISPATCH(InstructionSet)(); }

}  // namespace g3r::cpu
#endif
