// The near field: exact pair sums. Highway compiles this file once per instruction set.
//
// The sources of a task are gathered into one array per field, so that vectors are full whatever the sizes of the leaves they come from.
//
// Beyond the reach of a task, at most kMollifierReach<T> widths R, the kernels are plain powers of 1/rho. Within, they are polynomials in
// w = 2 (R^2 + 30) / R^2 * s / (s + 30) - 1 in [-1, 1], s = (rho / e)^2 in [0, R^2], fitted by Lawson iteration for the least relative
// error (float: 6e-8, double: 1e-15 before rounding). The mapping spreads the bell of exp(-s/2), so degree 10 and 24 suffice where a
// polynomial in s would need twice that. Where a task allows kRoughError, floats go without the Newton step of 1/rho, and degree 6 (1.3e-4)
// will do. A vector of sources takes the mollified path when any lane is near; the lanes that are not keep
// the plain value.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/near_field.cpp"
#include "cpu/near_field.h"

#include "kernels/kernel_polynomials.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include "cpu/wasm_doubles.h"  // NOLINT(llvm-include-order): adds to what stands above

#ifndef G3R_NEAR_FIELD_ONCE
#define G3R_NEAR_FIELD_ONCE
namespace g3r::cpu {
namespace {

constexpr int kMaxBatch = 9;

}  // namespace
}  // namespace g3r::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Tag = hn::CappedTag<T, kLanes>;
template <class T>
using Vec = hn::Vec<Tag<T>>;

// Relative error of the processor's estimate of 1/sqrt: 2^-14 of VRSQRT14PS, 1.5 * 2^-12 of RSQRTPS; others need the Newton step.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
constexpr double kEstimateError = 6.2e-5;
#elif HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
constexpr double kEstimateError = 3.7e-4;
#elif HWY_TARGET == HWY_WASM
constexpr double kEstimateError = kRoughPolynomialError / 5;  // it has quotients in their place: only the polynomials err
#else
constexpr double kEstimateError = 1;
#endif
constexpr bool kEstimateIsExact = HWY_TARGET == HWY_WASM;
constexpr double kRoughError = 5 * kEstimateError;  // of 1/rho to the fifth power, the highest in the kernels; the polynomials err less

template <class T, Precision kPrecision>
HWY_INLINE Vec<T> Reciprocal(Vec<T> a) {
  const Tag<T> d;
  if constexpr (sizeof(T) == 4) {
    const Vec<T> x = hn::ApproximateReciprocal(a);
    if constexpr (kPrecision == Precision::kRough || kEstimateIsExact) return x;
    return hn::Mul(x, hn::NegMulAdd(a, x, hn::Set(d, T{2})));
  } else {
    return hn::Div(hn::Set(d, T{1}), a);
  }
}

template <class T, Precision kPrecision>
HWY_INLINE Vec<T> ReciprocalSqrt(Vec<T> a) {
  const Tag<T> d;
  if constexpr (sizeof(T) == 4) {  // one Newton step after the estimate
    const Vec<T> x = hn::ApproximateReciprocalSqrt(a);
    if constexpr (kPrecision == Precision::kRough || kEstimateIsExact) return x;
    const Vec<T> half_ax = hn::Mul(hn::Mul(a, hn::Set(d, T{0.5})), x);
    return hn::Mul(x, hn::NegMulAdd(half_ax, x, hn::Set(d, T{1.5})));
  } else {
    return hn::Div(hn::Set(d, T{1}), hn::Sqrt(a));
  }
}

template <class T, int kDegree>
HWY_INLINE Vec<T> Horner(const T (&coefficients)[kDegree + 1], Vec<T> w) {
  const Tag<T> d;
  Vec<T> sum = hn::Set(d, coefficients[kDegree]);
  HWY_UNROLL(32)
  for (int k = kDegree - 1; k >= 0; --k) sum = hn::MulAdd(sum, w, hn::Set(d, coefficients[k]));
  return sum;
}

// What a form needs of the kernels, in 1/(4 pi) units: value = Phi or unused, flux = g, third = h or b.
template <class T>
struct Kernel {
  Vec<T> value;
  Vec<T> flux;
  Vec<T> third;
};

enum class Third { kNone, kStokeslet, kGradient };

template <class T, bool kValue, Third kThird>
HWY_INLINE Kernel<T> PlainKernel(Vec<T> inverse, Vec<T> width_squared) {
  const Tag<T> d;
  Kernel<T> k;
  const Vec<T> inverse2 = hn::Mul(inverse, inverse);
  k.value = inverse;
  k.flux = hn::Mul(inverse, inverse2);
  k.third = k.flux;
  if constexpr (kThird == Third::kStokeslet) {  // g (1 - 3 e^2 / rho^2); value becomes Phi + e^2 g
    k.third = hn::Mul(k.flux, hn::NegMulAdd(hn::Mul(hn::Set(d, T{3}), width_squared), inverse2, hn::Set(d, T{1})));
    k.value = hn::MulAdd(width_squared, k.flux, inverse);
  }
  if constexpr (kThird == Third::kGradient) k.third = hn::Mul(hn::Mul(hn::Set(d, T{3}), k.flux), inverse2);
  return k;
}

template <class T, Precision kPrecision, bool kValue, Third kThird>
HWY_INLINE Kernel<T> MollifiedKernel(Vec<T> r2, Vec<T> width_squared, Vec<T> inverse_width) {
  const Tag<T> d;
  using P = Polynomials<T, kPrecision>;
  const Vec<T> inverse_width2 = hn::Mul(inverse_width, inverse_width);
  const Vec<T> s = hn::Mul(r2, inverse_width2);
  const Vec<T> mapped = hn::Mul(s, Reciprocal<T, kPrecision>(hn::Add(s, hn::Set(d, static_cast<T>(kMapPole)))));
  const Vec<T> w = hn::MulSub(mapped, hn::Set(d, static_cast<T>(kMapScale<T>)), hn::Set(d, T{1}));
  const Vec<T> cube = hn::Mul(inverse_width, inverse_width2);
  Kernel<T> k;
  k.flux = hn::Mul(cube, Horner<T, P::kDegree>(P::kDoubleLayer, w));
  k.value = k.flux;
  if constexpr (kValue) k.value = hn::Mul(inverse_width, Horner<T, P::kDegree>(P::kSingleLayer, w));
  k.third = k.flux;
  if constexpr (kThird == Third::kStokeslet) {
    k.third = hn::Mul(cube, Horner<T, P::kDegree>(P::kStokeslet, w));
    k.value = hn::MulAdd(width_squared, k.flux, k.value);
  }
  if constexpr (kThird == Third::kGradient) k.third = hn::Mul(hn::Mul(cube, inverse_width2), Horner<T, P::kDegree>(P::kGradient, w));
  return k;
}

// The values of a vector of sources.
template <class T>
struct Fields {
  const T* first;
  std::size_t stride;
  HWY_INLINE Vec<T> operator()(std::size_t f) const { return hn::Load(Tag<T>(), first + f * stride); }
};

// Each form: what it needs, how many channels it sums, and the contribution of a vector of sources.
template <class T, int K>
struct GreenForm {
  static constexpr bool kValue = true;
  static constexpr Third kThird = Third::kNone;
  static constexpr int kFields = 3 + 2 * K;
  static constexpr int kChannels = K;
  static constexpr int kTargetData = 0;
  static HWY_INLINE void Add(Fields<T> f, Vec<T> dx, Vec<T> dy, Vec<T> dz, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> dot = hn::MulAdd(dx, f(0), hn::MulAdd(dy, f(1), hn::Mul(dz, f(2))));
    const Vec<T> flux = hn::Mul(k.flux, dot);
    HWY_UNROLL(9)
    for (std::size_t c = 0; c < K; ++c) {
      sum[c] = hn::MulAdd(k.value, f(3 + 2 * c), sum[c]);
      sum[c] = hn::MulAdd(flux, f(4 + 2 * c), sum[c]);
    }
  }
};

template <class T, int K>
struct GreenAdjointForm {
  static constexpr bool kValue = true;
  static constexpr Third kThird = Third::kNone;
  static constexpr int kFields = K;
  static constexpr int kChannels = K + 3;
  static constexpr int kTargetData = K;
  static HWY_INLINE void Add(Fields<T> f, Vec<T> dx, Vec<T> dy, Vec<T> dz, const Kernel<T>& k, const Vec<T>* u, Vec<T>* sum) {
    const Tag<T> d;
    Vec<T> charge = hn::Zero(d);
    HWY_UNROLL(9)
    for (std::size_t c = 0; c < K; ++c) {
      const Vec<T> q = f(c);
      charge = hn::MulAdd(u[c], q, charge);
      sum[c] = hn::MulAdd(k.value, q, sum[c]);
    }
    const Vec<T> flux = hn::Mul(k.flux, charge);
    sum[K] = hn::MulAdd(flux, dx, sum[K]);
    sum[K + 1] = hn::MulAdd(flux, dy, sum[K + 1]);
    sum[K + 2] = hn::MulAdd(flux, dz, sum[K + 2]);
  }
};

template <class T>
struct StokesWindingForm {
  static constexpr bool kValue = true;
  static constexpr Third kThird = Third::kStokeslet;
  static constexpr int kFields = 3;
  static constexpr int kChannels = 4;
  static constexpr int kTargetData = 0;
  static HWY_INLINE void Add(Fields<T> f, Vec<T> dx, Vec<T> dy, Vec<T> dz, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> ex = f(0);
    const Vec<T> ey = f(1);
    const Vec<T> ez = f(2);
    const Vec<T> dot = hn::MulAdd(dx, ex, hn::MulAdd(dy, ey, hn::Mul(dz, ez)));
    const Vec<T> along = hn::Mul(k.third, dot);
    sum[0] = hn::MulAdd(along, dx, hn::MulAdd(k.value, ex, sum[0]));
    sum[1] = hn::MulAdd(along, dy, hn::MulAdd(k.value, ey, sum[1]));
    sum[2] = hn::MulAdd(along, dz, hn::MulAdd(k.value, ez, sum[2]));
    sum[3] = hn::MulAdd(k.flux, dot, sum[3]);
  }
};

template <class T>
struct WindingForm {
  static constexpr bool kValue = false;
  static constexpr Third kThird = Third::kNone;
  static constexpr int kFields = 3;
  static constexpr int kChannels = 1;
  static constexpr int kTargetData = 0;
  static HWY_INLINE void Add(Fields<T> f, Vec<T> dx, Vec<T> dy, Vec<T> dz, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    sum[0] = hn::MulAdd(k.flux, hn::MulAdd(dx, f(0), hn::MulAdd(dy, f(1), hn::Mul(dz, f(2)))), sum[0]);
  }
};

template <class T>
struct WindingAdjointForm {
  static constexpr bool kValue = false;
  static constexpr Third kThird = Third::kNone;
  static constexpr int kFields = 1;
  static constexpr int kChannels = 3;
  static constexpr int kTargetData = 0;
  static HWY_INLINE void Add(Fields<T> f, Vec<T> dx, Vec<T> dy, Vec<T> dz, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> flux = hn::Mul(k.flux, f(0));
    sum[0] = hn::MulAdd(flux, dx, sum[0]);
    sum[1] = hn::MulAdd(flux, dy, sum[1]);
    sum[2] = hn::MulAdd(flux, dz, sum[2]);
  }
};

template <class T>
struct WindingGradientForm {
  static constexpr bool kValue = false;
  static constexpr Third kThird = Third::kGradient;
  static constexpr int kFields = 3;
  static constexpr int kChannels = 3;
  static constexpr int kTargetData = 0;
  static HWY_INLINE void Add(Fields<T> f, Vec<T> dx, Vec<T> dy, Vec<T> dz, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> ex = f(0);
    const Vec<T> ey = f(1);
    const Vec<T> ez = f(2);
    const Vec<T> dot = hn::MulAdd(dx, ex, hn::MulAdd(dy, ey, hn::Mul(dz, ez)));
    const Vec<T> along = hn::Mul(k.third, dot);
    sum[0] = hn::NegMulAdd(along, dx, hn::MulAdd(k.flux, ex, sum[0]));
    sum[1] = hn::NegMulAdd(along, dy, hn::MulAdd(k.flux, ey, sum[1]));
    sum[2] = hn::NegMulAdd(along, dz, hn::MulAdd(k.flux, ez, sum[2]));
  }
};

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
        const Vec<T> dx = hn::Sub(hn::Load(d, source + s), x);
        const Vec<T> dy = hn::Sub(hn::Load(d, source + stride + s), y);
        const Vec<T> dz = hn::Sub(hn::Load(d, source + 2 * stride + s), z);
        const Vec<T> r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
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
        Form::Add({source + kFirstField * stride + s, stride}, dx, dy, dz, k, u, sum);
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
      return RunWidths<T, Form<T, kMaxBatch>>(task);
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
