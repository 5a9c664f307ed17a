// Solid harmonics R_l^m of a vector of points, and their gradients. docs/math.md, "Expansions". To be included after
// <hwy/foreach_target.h>.
#if defined(G3R_CPU_REGULAR_HARMONICS_H) == defined(HWY_TARGET_TOGGLE)  // once for every instruction set
#ifdef G3R_CPU_REGULAR_HARMONICS_H
#undef G3R_CPU_REGULAR_HARMONICS_H
#else
#define G3R_CPU_REGULAR_HARMONICS_H
#endif

#include "cpu/lanes.h"
#include "kernels/expansion_index.h"

#ifndef G3R_REGULAR_HARMONICS_ONCE
#define G3R_REGULAR_HARMONICS_ONCE
namespace g3r::cpu {
namespace {

// R_{l+1}^m = up z R_l^m - down r^2 R_{l-1}^m, by l and m <= l.
template <class T>
struct Recurrence {
  T up[kMaxExpansionOrder + 1][kMaxExpansionOrder + 1] = {};
  T down[kMaxExpansionOrder + 1][kMaxExpansionOrder + 1] = {};

  constexpr Recurrence() {
    for (int l = 0; l <= kMaxExpansionOrder; ++l) {
      for (int m = 0; m <= l; ++m) {
        const double divisor = (l + 1 + m) * (l + 1 - m);
        up[l][m] = static_cast<T>((2.0 * l + 1) / divisor);
        down[l][m] = static_cast<T>(1 / divisor);
      }
    }
  }
};
template <class T>
constexpr Recurrence<T> kRecurrence;

}  // namespace
}  // namespace g3r::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

// Basis values B_a of one vector of points, in memory: basis[a * kLanes + lane].
template <class T>
void RegularHarmonics(Vec<T> x, Vec<T> y, Vec<T> z, int order, T* HWY_RESTRICT basis) {
  const Tag<T> d;
  const Vec<T> r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
  Vec<T> re_diagonal = hn::Set(d, T{1});
  Vec<T> im_diagonal = hn::Zero(d);
  for (int m = 0; m <= order; ++m) {
    if (m > 0) {  // times -(x + iy) / (2m)
      const Vec<T> scale = hn::Set(d, static_cast<T>(-0.5 / m));
      const Vec<T> re = hn::Mul(scale, hn::NegMulAdd(y, im_diagonal, hn::Mul(x, re_diagonal)));
      im_diagonal = hn::Mul(scale, hn::MulAdd(x, im_diagonal, hn::Mul(y, re_diagonal)));
      re_diagonal = re;
    }
    Vec<T> re = re_diagonal;
    Vec<T> im = im_diagonal;
    Vec<T> re_below = hn::Zero(d);
    Vec<T> im_below = hn::Zero(d);
    for (int l = m; l <= order; ++l) {
      hn::Store(re, d, basis + real_index(l, m) * kLanes);
      if (m > 0) hn::Store(im, d, basis + imaginary_index(l, m) * kLanes);
      const Vec<T> up = hn::Mul(hn::Set(d, kRecurrence<T>.up[l][m]), z);
      const Vec<T> down = hn::Mul(hn::Set(d, kRecurrence<T>.down[l][m]), r2);
      const Vec<T> re_next = hn::NegMulAdd(down, re_below, hn::Mul(up, re));
      const Vec<T> im_next = hn::NegMulAdd(down, im_below, hn::Mul(up, im));
      re_below = re;
      im_below = im;
      re = re_next;
      im = im_next;
    }
  }
}

// The gradient of B_a as combinations of B of one degree less:
//   g . grad R_l^m = g_z R_{l-1}^m - (g_x + i g_y)/2 R_{l-1}^{m-1} + (g_x - i g_y)/2 R_{l-1}^{m+1}
// Calls use(a, d/dx, d/dy, d/dz) for every coefficient a of degree >= 1.
template <class T, class Use>
HWY_INLINE void ForEachGradient(const T* HWY_RESTRICT basis, int order, const Use& use) {
  const Tag<T> d;
  const Vec<T> half = hn::Set(d, T{0.5});
  const auto load = [&](int l, int m, bool imaginary) HWY_ATTR {
    if (m > l || (imaginary && m == 0)) return hn::Zero(d);
    return hn::Load(d, basis + (imaginary ? imaginary_index(l, m) : real_index(l, m)) * kLanes);
  };
  for (int l = 1; l <= order; ++l) {
    use(real_index(l, 0), load(l - 1, 1, false), load(l - 1, 1, true), load(l - 1, 0, false));
    for (int m = 1; m <= l; ++m) {
      const Vec<T> re_up = load(l - 1, m + 1, false);
      const Vec<T> im_up = load(l - 1, m + 1, true);
      const Vec<T> re_down = load(l - 1, m - 1, false);
      const Vec<T> im_down = load(l - 1, m - 1, true);
      use(real_index(l, m), hn::Mul(half, hn::Sub(re_up, re_down)), hn::Mul(half, hn::Add(im_up, im_down)), load(l - 1, m, false));
      use(imaginary_index(l, m), hn::Mul(half, hn::Sub(im_up, im_down)), hn::Neg(hn::Mul(half, hn::Add(re_up, re_down))),
          load(l - 1, m, true));
    }
  }
}

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
