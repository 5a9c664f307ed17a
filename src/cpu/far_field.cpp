// The far field's vector kernels. Highway compiles this file once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/far_field.cpp"
#include "cpu/far_field.h"

#include "kernels/expansion_index.h"

#include <cstring>

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include "cpu/wasm_doubles.h"  // NOLINT(llvm-include-order): adds to what stands above

#ifndef G3R_FAR_FIELD_ONCE
#define G3R_FAR_FIELD_ONCE
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
namespace hn = hwy::HWY_NAMESPACE;

template <class T>
using Tag = hn::CappedTag<T, kLanes>;
template <class T>
using Vec = hn::Vec<Tag<T>>;

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

// acc[channel][a] += weight * value, vectors in memory.
template <class T>
HWY_INLINE void Accumulate(T* HWY_RESTRICT acc, Vec<T> weight, Vec<T> value) {
  const Tag<T> d;
  hn::Store(hn::MulAdd(weight, value, hn::Load(d, acc)), d, acc);
}

// The fields of kLanes sources from `begin` on, one after the other; missing sources are zero.
template <class T>
void LoadSources(const LeafTask<T>& task, std::size_t begin, T* HWY_RESTRICT fields) {
  const Tag<T> d;
  const std::size_t geometry = task.local_widths ? 4 : 3;
  for (std::size_t f = 0; f < geometry + task.value_count; ++f) {
    const T* from = f < 3          ? task.places + f * task.field_stride
                    : f < geometry ? task.source_width_squared
                                   : task.values + (f - geometry) * task.field_stride;
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
      const std::size_t left = task.count - HWY_MIN(task.count, begin + lane);
      const Vec<T> value = hn::LoadU(d, from + begin + lane);
      hn::Store(hn::IfThenElseZero(hn::FirstN(d, left), value), d, fields + f * kLanes + lane);
    }
  }
}

template <class T>
HWY_INLINE Vec<T> AllLanes(const T* HWY_RESTRICT acc) {  // of kLanes, added up to one vector
  const Tag<T> d;
  Vec<T> sum = hn::Load(d, acc);
  for (std::size_t lane = hn::Lanes(d); lane < kLanes; lane += hn::Lanes(d)) sum = hn::Add(sum, hn::Load(d, acc + lane));
  return sum;
}

#if HWY_TARGET != HWY_SCALAR
// The sum of the 128-bit blocks of a vector.
template <class D>
HWY_INLINE auto SumBlocks(D d, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(d) <= 4) {
    return v;
  } else {
    const hn::Half<D> half;
    return SumBlocks(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}
#endif

// out[a] = sum over the lanes of acc[a], for a < n; float: and for the rest of a multiple of four.
template <class T>
HWY_INLINE void SumLanes(const T* HWY_RESTRICT acc, std::size_t n, T* HWY_RESTRICT out) {
  const Tag<T> d;
#if HWY_TARGET != HWY_SCALAR
  if constexpr (sizeof(T) == 4) {  // four at a time: transposed within blocks of four
    const hn::Repartition<double, Tag<T>> pairs;
    for (std::size_t a = 0; a < n; a += 4) {
      const Vec<T> v0 = AllLanes(acc + a * kLanes);
      const Vec<T> v1 = AllLanes(acc + (a + 1) * kLanes);
      const Vec<T> v2 = AllLanes(acc + (a + 2) * kLanes);
      const Vec<T> v3 = AllLanes(acc + (a + 3) * kLanes);
      const auto low = hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, v0, v1), hn::InterleaveUpper(d, v0, v1)));
      const auto high = hn::BitCast(pairs, hn::Add(hn::InterleaveLower(d, v2, v3), hn::InterleaveUpper(d, v2, v3)));
      const Vec<T> blocks =
          hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, low, high)), hn::BitCast(d, hn::InterleaveUpper(pairs, low, high)));
      hn::StoreU(SumBlocks(d, blocks), hn::FixedTag<T, 4>(), out + a);
    }
    return;
  }
#endif
  for (std::size_t a = 0; a < n; ++a) out[a] = hn::GetLane(hn::SumOfLanes(d, AllLanes(acc + a * kLanes)));
}

template <class T>
void PointsToMultipole(const LeafTask<T>& task) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t n = coefficient_count(task.order);
  T* basis = task.workspace;
  T* acc = basis + n * kLanes;
  const T inverse_half = T{1} / task.half_side;
  const std::size_t first_field = task.local_widths ? 4 : 3;
  const auto batch = static_cast<std::size_t>(task.batch);
  T* fields = acc + task.channels * n * kLanes;
  std::memset(acc, 0, task.channels * n * kLanes * sizeof(T));
  for (std::size_t begin = 0; begin < task.count; begin += kLanes) {
    LoadSources(task, begin, fields);
    const T* f = fields + first_field * kLanes;
    for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
      const Vec<T> x = hn::Load(d, fields + lane);
      const Vec<T> y = hn::Load(d, fields + kLanes + lane);
      const Vec<T> z = hn::Load(d, fields + 2 * kLanes + lane);
      const Vec<T> unit = hn::Set(d, inverse_half);
      RegularHarmonics<T>(hn::Mul(x, unit), hn::Mul(y, unit), hn::Mul(z, unit), task.order, basis + lane);
      const auto field = [&](std::size_t k) HWY_ATTR { return hn::Load(d, f + k * kLanes + lane); };
      const auto target = [&](std::size_t channel, std::size_t a) HWY_ATTR { return acc + (channel * n + a) * kLanes + lane; };
      if (task.form == NearForm::kGreenAdjoint || task.form == NearForm::kWindingAdjoint) {
        for (std::size_t a = 0; a < n; ++a) {
          const Vec<T> b = hn::Load(d, basis + a * kLanes + lane);
          for (std::size_t k = 0; k < batch; ++k) Accumulate<T>(target(k, a), field(k), b);
        }
        continue;
      }
      const Vec<T> ex = hn::Mul(unit, field(0));  // dipoles: grad in units of the half side
      const Vec<T> ey = hn::Mul(unit, field(1));
      const Vec<T> ez = hn::Mul(unit, field(2));
      const bool stokes = task.form == NearForm::kStokesWinding;
      if (task.form == NearForm::kGreen) {
        for (std::size_t a = 0; a < n; ++a) {
          const Vec<T> b = hn::Load(d, basis + a * kLanes + lane);
          for (std::size_t k = 0; k < batch; ++k) Accumulate<T>(target(k, a), field(3 + 2 * k), b);
        }
      } else if (stokes) {
        const Vec<T> along = hn::MulAdd(x, field(0), hn::MulAdd(y, field(1), hn::Mul(z, field(2))));
        for (std::size_t a = 0; a < n; ++a) {
          const Vec<T> b = hn::Load(d, basis + a * kLanes + lane);
          for (std::size_t k = 0; k < 3; ++k) Accumulate<T>(target(4 + k, a), field(k), b);
          Accumulate<T>(target(7, a), along, b);
        }
      }
      ForEachGradient<T>(basis + lane, task.order, [&](std::size_t a, Vec<T> gx, Vec<T> gy, Vec<T> gz) HWY_ATTR {
        const Vec<T> dipole = hn::Neg(hn::MulAdd(ex, gx, hn::MulAdd(ey, gy, hn::Mul(ez, gz))));
        if (task.form == NearForm::kGreen) {
          for (std::size_t k = 0; k < batch; ++k) Accumulate<T>(target(k, a), field(4 + 2 * k), dipole);
        } else {
          hn::Store(hn::Add(dipole, hn::Load(d, target(0, a))), d, target(0, a));
          if (stokes) {  // E less P, which is added at the end
            Accumulate<T>(target(1, a), x, dipole);
            Accumulate<T>(target(2, a), y, dipole);
            Accumulate<T>(target(3, a), z, dipole);
            if (task.local_widths) Accumulate<T>(target(8, a), hn::Load(d, fields + 3 * kLanes + lane), dipole);
          }
        }
      });
    }
  }
  for (std::size_t c = 0; c < task.channels; ++c) {
    T* multipole = task.multipole + c * task.stride;
    SumLanes<T>(acc + c * n * kLanes, n, multipole);
    for (std::size_t a = n; a < task.stride; ++a) multipole[a] = T{0};
  }
  if (task.form == NearForm::kStokesWinding) {
    for (std::size_t i = 0; i < 3 * task.stride; ++i) task.multipole[task.stride + i] += task.multipole[4 * task.stride + i];
  }
}

// sum_a L_a B_a
template <class T>
HWY_INLINE Vec<T> Evaluate(const T* local, const T* basis, std::size_t n) {
  const Tag<T> d;
  Vec<T> even = hn::Zero(d);
  Vec<T> odd = hn::Zero(d);
  std::size_t a = 0;
  for (; a + 1 < n; a += 2) {
    even = hn::MulAdd(hn::Set(d, local[a]), hn::Load(d, basis + a * kLanes), even);
    odd = hn::MulAdd(hn::Set(d, local[a + 1]), hn::Load(d, basis + (a + 1) * kLanes), odd);
  }
  if (a < n) even = hn::MulAdd(hn::Set(d, local[a]), hn::Load(d, basis + a * kLanes), even);
  return hn::Add(even, odd);
}

template <class T>
HWY_INLINE void AddTo(double* out, Vec<T> value) {
  const Tag<T> d;
  HWY_ALIGN T part[kLanes];
  hn::Store(value, d, part);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) out[i] += static_cast<double>(part[i]);
}

template <class T>
struct Gradient {
  Vec<T> x;
  Vec<T> y;
  Vec<T> z;
};

// The gradients of kCount expansions, times scale.
template <class T, std::size_t kCount>
HWY_INLINE void EvaluateGradients(const T* const (&locals)[kCount], const T* basis, int order, Vec<T> scale, Gradient<T> (&g)[kCount]) {
  const Tag<T> d;
  for (Gradient<T>& one : g) one = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  ForEachGradient<T>(basis, order, [&](std::size_t a, Vec<T> gx, Vec<T> gy, Vec<T> gz) HWY_ATTR {
    for (std::size_t c = 0; c < kCount; ++c) {
      const Vec<T> l = hn::Set(d, locals[c][a]);
      g[c].x = hn::MulAdd(l, gx, g[c].x);
      g[c].y = hn::MulAdd(l, gy, g[c].y);
      g[c].z = hn::MulAdd(l, gz, g[c].z);
    }
  });
  for (Gradient<T>& one : g) one = {hn::Mul(one.x, scale), hn::Mul(one.y, scale), hn::Mul(one.z, scale)};
}

// The locals of kStokesWinding at the points of a leaf, put together: docs/math.md, "The Stokes far field".
template <class T>
struct StokesLocals {
  static constexpr std::size_t kValues = 5;  // W of all pairs, W of those with E, E + P
  const T* values[kValues];
  const T* gradients[4];  // Q - e^2 W (local widths: Q - half of the W of e^2 eta), P

  StokesLocals() = default;
  // `memory`: 5 n elements.
  StokesLocals(const LeafTask<T>& task, std::size_t n, T* memory) {
    const auto local = [&](std::size_t channel) { return task.local + channel * task.stride; };
    const T width2 = task.local_widths ? T{0.5} : task.uniform_width_squared;
    const T* weighted = task.local_widths ? local(kStokesLocals) : memory;
    for (std::size_t a = 0; a < n; ++a) memory[a] = local(0)[a] + local(kTransposedWinding)[a];
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t a = 0; a < n; ++a) memory[(1 + k) * n + a] = local(1 + k)[a] + local(4 + k)[a];
      values[2 + k] = memory + (1 + k) * n;
      gradients[1 + k] = local(4 + k);
    }
    for (std::size_t a = 0; a < n; ++a) memory[4 * n + a] = local(7)[a] - width2 * weighted[a];
    values[0] = memory;
    values[1] = local(0);
    gradients[0] = memory + 4 * n;
  }
};

// One vector of points: S in s, W in w; `width_squared` of the points, only with local widths.
template <class T>
HWY_INLINE void StokesAtPoints(const LeafTask<T>& task, const StokesLocals<T>& locals, const T* basis, std::size_t n, const Vec<T> (&at)[3],
                               Vec<T> width_squared, Vec<T> (&s)[3], Vec<T>& w) {
  const Tag<T> d;
  const Vec<T> unit = hn::Set(d, T{1} / task.half_side);
  Vec<T> value[StokesLocals<T>::kValues];
  for (Vec<T>& v : value) v = hn::Zero(d);
  for (std::size_t a = 0; a < n; ++a) {
    const Vec<T> b = hn::Load(d, basis + a * kLanes);
    for (std::size_t c = 0; c < StokesLocals<T>::kValues; ++c) value[c] = hn::MulAdd(hn::Set(d, locals.values[c][a]), b, value[c]);
  }
  w = hn::Mul(unit, value[0]);
  Gradient<T> g[4];
  EvaluateGradients<T, 4>(locals.gradients, basis, task.order, hn::Mul(unit, unit), g);
  if (task.local_widths) {
    Gradient<T> of_w[1];
    EvaluateGradients<T, 1>({locals.values[0]}, basis, task.order, hn::Mul(unit, unit), of_w);
    const Vec<T> half = hn::Mul(hn::Set(d, T{0.5}), width_squared);
    g[0] = {hn::NegMulAdd(half, of_w[0].x, g[0].x), hn::NegMulAdd(half, of_w[0].y, g[0].y), hn::NegMulAdd(half, of_w[0].z, g[0].z)};
  }
  for (std::size_t b = 0; b < 3; ++b) {
    g[0] = {hn::NegMulAdd(at[b], g[1 + b].x, g[0].x), hn::NegMulAdd(at[b], g[1 + b].y, g[0].y), hn::NegMulAdd(at[b], g[1 + b].z, g[0].z)};
  }
  const Vec<T> side[3] = {g[0].x, g[0].y, g[0].z};
  for (std::size_t k = 0; k < 3; ++k) s[k] = hn::Add(side[k], hn::Mul(unit, hn::NegMulAdd(at[k], value[1], value[2 + k])));
}

template <class T>
void LocalToPoints(const LeafTask<T>& task, const StokesLocals<T>& stokes) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t n = coefficient_count(task.order);
  T* basis = task.workspace;
  const auto batch = static_cast<std::size_t>(task.batch);
  const T inverse_half = T{1} / task.half_side;
  const Vec<T> unit = hn::Set(d, inverse_half);
  const Vec<T> unit2 = hn::Set(d, inverse_half * inverse_half);
  const auto local = [&](std::size_t channel) { return task.local + channel * task.stride; };
  for (std::size_t block = 0; block < task.block_count; ++block) {
    for (std::size_t lane = 0; lane < kLanes; lane += lanes) {
      const std::size_t at = block * kLanes + lane;
      const Vec<T> x = hn::Load(d, task.x + at);
      const Vec<T> y = hn::Load(d, task.y + at);
      const Vec<T> z = hn::Load(d, task.z + at);
      RegularHarmonics<T>(hn::Mul(x, unit), hn::Mul(y, unit), hn::Mul(z, unit), task.order, basis);
      switch (task.form) {
        case NearForm::kGreen: {
          double* out = task.out + block * batch * kLanes + lane;
          for (std::size_t k = 0; k < batch; ++k) AddTo<T>(out + k * kLanes, hn::Mul(unit, Evaluate<T>(local(k), basis, n)));
          break;
        }
        case NearForm::kGreenAdjoint: {
          double* out = task.out + block * (batch + 3) * kLanes + lane;
          const T* u = task.u + block * batch * kLanes + lane;
          for (std::size_t k = 0; k < batch; ++k) AddTo<T>(out + k * kLanes, hn::Mul(unit, Evaluate<T>(local(k), basis, n)));
          Gradient<T> g{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
          ForEachGradient<T>(basis, task.order, [&](std::size_t a, Vec<T> gx, Vec<T> gy, Vec<T> gz) HWY_ATTR {
            Vec<T> l = hn::Zero(d);  // sum_k u_k(target) L_k
            for (std::size_t k = 0; k < batch; ++k) l = hn::MulAdd(hn::Load(d, u + k * kLanes), hn::Set(d, local(k)[a]), l);
            g.x = hn::MulAdd(l, gx, g.x);
            g.y = hn::MulAdd(l, gy, g.y);
            g.z = hn::MulAdd(l, gz, g.z);
          });
          AddTo<T>(out + batch * kLanes, hn::Mul(unit2, g.x));
          AddTo<T>(out + (batch + 1) * kLanes, hn::Mul(unit2, g.y));
          AddTo<T>(out + (batch + 2) * kLanes, hn::Mul(unit2, g.z));
          break;
        }
        case NearForm::kWindingGradient: {
          double* out = task.out + block * 3 * kLanes + lane;
          Gradient<T> g[1];
          EvaluateGradients<T, 1>({local(0)}, basis, task.order, unit2, g);
          AddTo<T>(out, hn::Neg(g[0].x));
          AddTo<T>(out + kLanes, hn::Neg(g[0].y));
          AddTo<T>(out + 2 * kLanes, hn::Neg(g[0].z));
          break;
        }
        case NearForm::kWindingAdjoint: {
          double* out = task.out + block * 3 * kLanes + lane;
          Gradient<T> g[1];
          EvaluateGradients<T, 1>({local(0)}, basis, task.order, unit2, g);
          AddTo<T>(out, g[0].x);
          AddTo<T>(out + kLanes, g[0].y);
          AddTo<T>(out + 2 * kLanes, g[0].z);
          break;
        }
        case NearForm::kWinding:
          AddTo<T>(task.out + block * kLanes + lane, hn::Mul(unit, Evaluate<T>(local(0), basis, n)));
          break;
        case NearForm::kStokesWinding: {
          double* out = task.out + block * 4 * kLanes + lane;
          Vec<T> s[3];
          Vec<T> w;
          StokesAtPoints<T>(task, stokes, basis, n, {x, y, z}, task.local_widths ? hn::Load(d, task.width_squared + at) : hn::Zero(d), s,
                            w);
          for (std::size_t k = 0; k < 3; ++k) AddTo<T>(out + k * kLanes, s[k]);
          AddTo<T>(out + 3 * kLanes, w);
          break;
        }
      }
    }
  }
}

template <class T>
void LocalToPoints(const LeafTask<T>& task) {
  if (task.form == NearForm::kStokesWinding) {
    const std::size_t n = coefficient_count(task.order);
    return LocalToPoints(task, StokesLocals<T>(task, n, task.workspace + n * kLanes));
  }
  LocalToPoints(task, StokesLocals<T>());
}

void PointsToMultipoleFloat(const LeafTask<float>& task) { PointsToMultipole(task); }
void PointsToMultipoleDouble(const LeafTask<double>& task) { PointsToMultipole(task); }
void LocalToPointsFloat(const LeafTask<float>& task) { LocalToPoints(task); }
void LocalToPointsDouble(const LeafTask<double>& task) { LocalToPoints(task); }

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace g3r::cpu {

HWY_EXPORT(PointsToMultipoleFloat);
HWY_EXPORT(PointsToMultipoleDouble);
HWY_EXPORT(LocalToPointsFloat);
HWY_EXPORT(LocalToPointsDouble);

// P2M: basis, accumulators and fields of one vector of sources. L2P (channels = 1): basis and one expansion.
std::size_t leaf_workspace(std::size_t coefficients, std::size_t channels) {
  return (coefficients * (1 + channels) + kMostFields) * kLanes;
}

void points_to_multipole(const LeafTask<float>& task) { HWY_DYNAMIC_DISPATCH(PointsToMultipoleFloat)(task); }
void points_to_multipole(const LeafTask<double>& task) { HWY_DYNAMIC_DISPATCH(PointsToMultipoleDouble)(task); }
void local_to_points(const LeafTask<float>& task) { HWY_DYNAMIC_DISPATCH(LocalToPointsFloat)(task); }
void local_to_points(const LeafTask<double>& task) { HWY_DYNAMIC_DISPATCH(LocalToPointsDouble)(task); }

}  // namespace g3r::cpu
#endif
