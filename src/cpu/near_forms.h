// What the forms of cpu/near_field.h add up for each source. To be included after <hwy/foreach_target.h>.
#if defined(G3R_CPU_NEAR_FORMS_H) == defined(HWY_TARGET_TOGGLE)  // once for every instruction set
#ifdef G3R_CPU_NEAR_FORMS_H
#undef G3R_CPU_NEAR_FORMS_H
#else
#define G3R_CPU_NEAR_FORMS_H
#endif

#include "cpu/near_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

// The values of a vector of sources.
template <class T>
struct Fields {
  const T* first;
  std::size_t stride;
  HWY_INLINE Vec<T> operator()(std::size_t f) const { return hn::Load(Tag<T>(), first + f * stride); }
};

// What a form needs of the kernels, its fields per source, its channels and its target data.
template <bool kNeedsValue, Third kNeedsThird, int kFieldsOfSource, int kSums, int kDataOfTarget = 0>
struct FormShape {
  static constexpr bool kValue = kNeedsValue;
  static constexpr Third kThird = kNeedsThird;
  static constexpr int kFields = kFieldsOfSource;
  static constexpr int kChannels = kSums;
  static constexpr int kTargetData = kDataOfTarget;
};

// r of a vector of sources: source - target.
template <class T>
struct Difference {
  Vec<T> x;
  Vec<T> y;
  Vec<T> z;
  // r . eta
  HWY_INLINE Vec<T> Dot(Vec<T> ex, Vec<T> ey, Vec<T> ez) const { return hn::MulAdd(x, ex, hn::MulAdd(y, ey, hn::Mul(z, ez))); }
  // sum += factor r
  HWY_INLINE void AddTo(Vec<T> factor, Vec<T>* sum) const {
    sum[0] = hn::MulAdd(factor, x, sum[0]);
    sum[1] = hn::MulAdd(factor, y, sum[1]);
    sum[2] = hn::MulAdd(factor, z, sum[2]);
  }
};

// Each form adds the contribution of a vector of sources to its channels.
template <class T, int K>
struct GreenForm : FormShape<true, Third::kNone, 3 + 2 * K, K> {
  static HWY_INLINE void Add(Fields<T> f, const Difference<T>& r, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> flux = hn::Mul(k.flux, r.Dot(f(0), f(1), f(2)));
    HWY_UNROLL(9)
    for (std::size_t c = 0; c < K; ++c) {
      sum[c] = hn::MulAdd(k.value, f(3 + 2 * c), sum[c]);
      sum[c] = hn::MulAdd(flux, f(4 + 2 * c), sum[c]);
    }
  }
};

template <class T, int K>
struct GreenAdjointForm : FormShape<true, Third::kNone, K, K + 3, K> {
  static HWY_INLINE void Add(Fields<T> f, const Difference<T>& r, const Kernel<T>& k, const Vec<T>* u, Vec<T>* sum) {
    Vec<T> charge = hn::Zero(Tag<T>());
    HWY_UNROLL(9)
    for (std::size_t c = 0; c < K; ++c) {
      const Vec<T> q = f(c);
      charge = hn::MulAdd(u[c], q, charge);
      sum[c] = hn::MulAdd(k.value, q, sum[c]);
    }
    r.AddTo(hn::Mul(k.flux, charge), sum + K);
  }
};

template <class T>
struct StokesWindingForm : FormShape<true, Third::kStokeslet, 3, 4> {
  static HWY_INLINE void Add(Fields<T> f, const Difference<T>& r, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> eta[3] = {f(0), f(1), f(2)};
    const Vec<T> dot = r.Dot(eta[0], eta[1], eta[2]);
    for (std::size_t a = 0; a < 3; ++a) sum[a] = hn::MulAdd(k.value, eta[a], sum[a]);
    r.AddTo(hn::Mul(k.third, dot), sum);
    sum[3] = hn::MulAdd(k.flux, dot, sum[3]);
  }
};

template <class T>
struct WindingForm : FormShape<false, Third::kNone, 3, 1> {
  static HWY_INLINE void Add(Fields<T> f, const Difference<T>& r, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    sum[0] = hn::MulAdd(k.flux, r.Dot(f(0), f(1), f(2)), sum[0]);
  }
};

template <class T>
struct WindingAdjointForm : FormShape<false, Third::kNone, 1, 3> {
  static HWY_INLINE void Add(Fields<T> f, const Difference<T>& r, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    r.AddTo(hn::Mul(k.flux, f(0)), sum);
  }
};

template <class T>
struct WindingGradientForm : FormShape<false, Third::kGradient, 3, 3> {
  static HWY_INLINE void Add(Fields<T> f, const Difference<T>& r, const Kernel<T>& k, const Vec<T>* /*u*/, Vec<T>* sum) {
    const Vec<T> eta[3] = {f(0), f(1), f(2)};
    const Vec<T> along = hn::Mul(k.third, r.Dot(eta[0], eta[1], eta[2]));
    for (std::size_t a = 0; a < 3; ++a) sum[a] = hn::MulAdd(k.flux, eta[a], sum[a]);
    r.AddTo(hn::Neg(along), sum);
  }
};

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
