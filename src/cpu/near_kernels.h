// The kernels by SIMD. To be included after <hwy/foreach_target.h>.
//
// Beyond the reach of a task, at most kMollifierReach<T> widths R, the kernels are plain powers of 1/rho. Within, they are polynomials in
// w = 2 (R^2 + 30) / R^2 * s / (s + 30) - 1 in [-1, 1], s = (rho / e)^2 in [0, R^2], fitted by Lawson iteration for the least relative
// error (float: 6e-8, double: 1e-15 before rounding). The mapping spreads the bell of exp(-s/2), so degree 10 and 24 suffice where a
// polynomial in s would need twice that. Where a task allows kRoughError, floats go without the Newton step of 1/rho, and degree 6 (1.3e-4)
// will do. A vector of sources takes the mollified path when any lane is near; the lanes that are not keep the plain value.
#if defined(G3R_CPU_NEAR_KERNELS_H) == defined(HWY_TARGET_TOGGLE)  // once for every instruction set
#ifdef G3R_CPU_NEAR_KERNELS_H
#undef G3R_CPU_NEAR_KERNELS_H
#else
#define G3R_CPU_NEAR_KERNELS_H
#endif

#include "cpu/lanes.h"
#include "kernels/kernel_polynomials.h"

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

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

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
