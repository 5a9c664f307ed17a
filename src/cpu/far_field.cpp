// The far field's vector kernels. Highway compiles this file once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/far_field.cpp"
#include "cpu/far_field.h"

#include "sum/expansions.h"

#include <array>
#include <cstring>
#include <type_traits>

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

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
      const double divisor = static_cast<double>((l + 1 + m) * (l + 1 - m));
      const Vec<T> up = hn::Mul(hn::Set(d, static_cast<T>((2.0 * l + 1) / divisor)), z);
      const Vec<T> down = hn::Mul(hn::Set(d, static_cast<T>(1 / divisor)), r2);
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
  for (std::size_t f = 0; f < task.field_count; ++f) {
    for (std::size_t lane = 0; lane < kLanes; lane += hn::Lanes(d)) {
      const std::size_t left = task.count - HWY_MIN(task.count, begin + lane);
      const Vec<T> value = hn::LoadU(d, task.fields + f * task.field_stride + begin + lane);
      hn::Store(hn::IfThenElseZero(hn::FirstN(d, left), value), d, fields + f * kLanes + lane);
    }
  }
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
      if (task.form == NearForm::kGreenAdjoint) {
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
          for (std::size_t k = 0; k < 3; ++k) {
            Accumulate<T>(target(1 + k, a), field(k), b);
            Accumulate<T>(target(4 + k, a), field(k), b);
          }
          Accumulate<T>(target(7, a), along, b);
        }
      }
      ForEachGradient<T>(basis + lane, task.order, [&](std::size_t a, Vec<T> gx, Vec<T> gy, Vec<T> gz) HWY_ATTR {
        const Vec<T> dipole = hn::Neg(hn::MulAdd(ex, gx, hn::MulAdd(ey, gy, hn::Mul(ez, gz))));
        if (task.form == NearForm::kGreen) {
          for (std::size_t k = 0; k < batch; ++k) Accumulate<T>(target(k, a), field(4 + 2 * k), dipole);
        } else {
          hn::Store(hn::Add(dipole, hn::Load(d, target(0, a))), d, target(0, a));
          if (stokes) {
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
    for (std::size_t a = 0; a < n; ++a) {
      Vec<T> sum = hn::Load(d, acc + (c * n + a) * kLanes);
      for (std::size_t lane = lanes; lane < kLanes; lane += lanes) sum = hn::Add(sum, hn::Load(d, acc + (c * n + a) * kLanes + lane));
      task.multipole[c * task.stride + a] = hn::GetLane(hn::SumOfLanes(d, sum));
    }
    for (std::size_t a = n; a < task.stride; ++a) task.multipole[c * task.stride + a] = T{0};
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

template <class T>
HWY_INLINE Gradient<T> EvaluateGradient(const T* local, const T* basis, int order, Vec<T> scale) {
  const Tag<T> d;
  Gradient<T> g{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  ForEachGradient<T>(basis, order, [&](std::size_t a, Vec<T> gx, Vec<T> gy, Vec<T> gz) HWY_ATTR {
    const Vec<T> l = hn::Set(d, local[a]);
    g.x = hn::MulAdd(l, gx, g.x);
    g.y = hn::MulAdd(l, gy, g.y);
    g.z = hn::MulAdd(l, gz, g.z);
  });
  return {hn::Mul(g.x, scale), hn::Mul(g.y, scale), hn::Mul(g.z, scale)};
}

template <class T>
void LocalToPoints(const LeafTask<T>& task) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t n = coefficient_count(task.order);
  T* basis = task.workspace;
  const auto batch = static_cast<std::size_t>(task.batch);
  const T inverse_half = T{1} / task.half_side;
  const Vec<T> unit = hn::Set(d, inverse_half);
  const Vec<T> unit2 = hn::Set(d, inverse_half * inverse_half);
  const auto local = [&](std::size_t channel) { return task.local + channel * task.stride; };
  T* winding = basis + n * kLanes;  // of all pairs
  if (task.form == NearForm::kStokesWinding) {
    for (std::size_t a = 0; a < n; ++a) winding[a] = local(0)[a] + local(kTransposedWinding)[a];
  }
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
          const Gradient<T> g = EvaluateGradient<T>(local(0), basis, task.order, unit2);
          AddTo<T>(out, hn::Neg(g.x));
          AddTo<T>(out + kLanes, hn::Neg(g.y));
          AddTo<T>(out + 2 * kLanes, hn::Neg(g.z));
          break;
        }
        case NearForm::kStokesWinding: {
          double* out = task.out + block * 4 * kLanes + lane;
          const Vec<T> forward_w = hn::Mul(unit, Evaluate<T>(local(0), basis, n));
          const Vec<T> w = hn::Mul(unit, Evaluate<T>(winding, basis, n));
          const Gradient<T> grad_w = EvaluateGradient<T>(winding, basis, task.order, unit2);
          Vec<T> width2 = hn::Set(d, task.uniform_width_squared);
          Gradient<T> mollified{hn::Mul(width2, grad_w.x), hn::Mul(width2, grad_w.y), hn::Mul(width2, grad_w.z)};
          if (task.local_widths) {  // the mean of both squared widths
            width2 = hn::Load(d, task.width_squared + at);
            const Vec<T> half = hn::Set(d, T{0.5});
            const Gradient<T> weighted = EvaluateGradient<T>(local(kStokesLocals), basis, task.order, unit2);
            mollified.x = hn::Mul(half, hn::MulAdd(width2, grad_w.x, weighted.x));
            mollified.y = hn::Mul(half, hn::MulAdd(width2, grad_w.y, weighted.y));
            mollified.z = hn::Mul(half, hn::MulAdd(width2, grad_w.z, weighted.z));
          }
          Gradient<T> transposed = EvaluateGradient<T>(local(7), basis, task.order, unit2);
          const Vec<T> at_point[3] = {x, y, z};
          for (std::size_t k = 0; k < 3; ++k) {
            const Gradient<T> p = EvaluateGradient<T>(local(4 + k), basis, task.order, unit2);
            transposed.x = hn::NegMulAdd(at_point[k], p.x, transposed.x);
            transposed.y = hn::NegMulAdd(at_point[k], p.y, transposed.y);
            transposed.z = hn::NegMulAdd(at_point[k], p.z, transposed.z);
          }
          const Vec<T> side[3] = {transposed.x, transposed.y, transposed.z};
          const Vec<T> extra[3] = {mollified.x, mollified.y, mollified.z};
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec<T> e = hn::Mul(unit, Evaluate<T>(local(1 + k), basis, n));
            const Vec<T> p = hn::Mul(unit, Evaluate<T>(local(4 + k), basis, n));
            const Vec<T> forward = hn::NegMulAdd(at_point[k], forward_w, e);
            AddTo<T>(out + k * kLanes, hn::Sub(hn::Add(forward, hn::Add(p, side[k])), extra[k]));
          }
          AddTo<T>(out + 3 * kLanes, w);
          break;
        }
      }
    }
  }
}

constexpr std::size_t kTile = 8;  // expansions per pass: 2 x 8 accumulators and their operands fit 32 registers

// Rows [row, row + kVectors vectors) of the matrix times kCount expansions.
template <class T, std::size_t kVectors, std::size_t kCount>
HWY_INLINE void MultiplyTile(const TranslationMatrix<T>& matrix, std::size_t row, const T* const* from, Vec<T> (&sum)[kVectors][kCount]) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t v = 0; v < kVectors; ++v) {
    for (std::size_t c = 0; c < kCount; ++c) sum[v][c] = hn::Zero(d);
  }
  const T* column = matrix.data + row;
  for (std::size_t j = 0; j < matrix.columns; ++j, column += matrix.stride) {
    Vec<T> m[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) m[v] = hn::Load(d, column + v * lanes);
    for (std::size_t c = 0; c < kCount; ++c) {
      const Vec<T> value = hn::Set(d, from[c][j]);
      for (std::size_t v = 0; v < kVectors; ++v) sum[v][c] = hn::MulAdd(m[v], value, sum[v][c]);
    }
  }
}

template <class T, std::size_t kVectors, std::size_t kCount>
HWY_INLINE void TranslateTile(const TranslationMatrix<T>& matrix, std::size_t row, const T* const* from, T* const* to) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  Vec<T> sum[kVectors][kCount];
  MultiplyTile<T, kVectors, kCount>(matrix, row, from, sum);
  for (std::size_t c = 0; c < kCount; ++c) {
    for (std::size_t v = 0; v < kVectors; ++v) {
      T* at = to[c] + row + v * lanes;
      hn::Store(hn::Add(sum[v][c], hn::Load(d, at)), d, at);
    }
  }
}

// The matrix does not mix expansions, so moments are moved after it, where that is a few operations per vector.
template <class T, std::size_t kVectors, std::size_t kCount>
HWY_INLINE void TranslateStokesTile(const TranslationMatrix<T>& matrix, std::size_t row, const T* const* from, T* const* to,
                                    const std::array<T, 3>& move) {
  const Tag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  Vec<T> sum[kVectors][kCount];
  MultiplyTile<T, kVectors, kCount>(matrix, row, from, sum);
  for (std::size_t v = 0; v < kVectors; ++v) {
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec<T> shift = hn::Set(d, move[a]);
      sum[v][1 + a] = hn::MulAdd(shift, sum[v][0], sum[v][1 + a]);
      sum[v][7] = hn::MulAdd(shift, sum[v][4 + a], sum[v][7]);
    }
    for (std::size_t c = 0; c < kCount; ++c) {
      T* at = to[c] + row + v * lanes;
      hn::Store(hn::Add(sum[v][c], hn::Load(d, at)), d, at);
    }
  }
}

template <class T, std::size_t kVectors>
HWY_INLINE void TranslateRows(const TranslationMatrix<T>& matrix, std::size_t row, const T* const* from, T* const* to, std::size_t count) {
  std::size_t c = 0;
  for (; c + kTile <= count; c += kTile) TranslateTile<T, kVectors, kTile>(matrix, row, from + c, to + c);
  for (; c + 4 <= count; c += 4) TranslateTile<T, kVectors, 4>(matrix, row, from + c, to + c);
  for (; c + 2 <= count; c += 2) TranslateTile<T, kVectors, 2>(matrix, row, from + c, to + c);
  for (; c < count; ++c) TranslateTile<T, kVectors, 1>(matrix, row, from + c, to + c);
}

// Calls use(vectors (as a type), first row) for all rows.
template <class T, class Use>
HWY_INLINE void ForRows(std::size_t rows, const Use& use) {
  const std::size_t lanes = hn::Lanes(Tag<T>());
  std::size_t row = 0;
  for (; row + 2 * lanes <= rows; row += 2 * lanes) use(std::integral_constant<std::size_t, 2>(), row);
  for (; row < rows; row += lanes) use(std::integral_constant<std::size_t, 1>(), row);
}

template <class T, std::size_t kChannels>
void TranslateStokes(const TranslationMatrix<T>& matrix, const Translation<T>* translations, std::size_t count, std::size_t distance) {
  const T* from[kChannels];
  T* to[kChannels];
  for (std::size_t i = 0; i < count; ++i) {
    const Translation<T>& t = translations[i];
    for (std::size_t c = 0; c < kChannels; ++c) {
      from[c] = t.from + c * distance;
      to[c] = t.to + c * distance;
    }
    ForRows<T>(matrix.rows,
               [&](auto vectors, std::size_t row) HWY_ATTR { TranslateStokesTile<T, vectors, kChannels>(matrix, row, from, to, t.move); });
  }
}

// M2L of one form of S: the expansions taken from a source, and where they go at the target.
template <bool kTransposed, bool kWeighted>
struct StokesRoute {
  static constexpr std::size_t kCount = (kTransposed ? 5 : 4) + (kWeighted ? 1 : 0);
  static constexpr std::size_t from(std::size_t c) {
    if (c == 0) return 0;
    return kWeighted && c == kCount - 1 ? kStokesMultipoles : c + (kTransposed ? 3 : 0);
  }
  static constexpr std::size_t to(std::size_t c) {
    if (c == 0) return kTransposed ? kTransposedWinding : 0;
    return kWeighted && c == kCount - 1 ? kStokesLocals : from(c);
  }
};

template <class T, std::size_t kVectors, std::size_t kPairs, bool kTransposed, bool kWeighted>
HWY_INLINE void StokesPairsTile(const TranslationMatrix<T>& matrix, std::size_t row, const Translation<T>* pairs, std::size_t distance) {
  using Route = StokesRoute<kTransposed, kWeighted>;
  constexpr std::size_t kCount = Route::kCount;
  const Tag<T> d;
  const T* from[kPairs * kCount];
  for (std::size_t p = 0; p < kPairs; ++p) {
    for (std::size_t c = 0; c < kCount; ++c) from[p * kCount + c] = pairs[p].from + Route::from(c) * distance;
  }
  Vec<T> sum[kVectors][kPairs * kCount];
  MultiplyTile<T, kVectors, kPairs * kCount>(matrix, row, from, sum);
  for (std::size_t p = 0; p < kPairs; ++p) {
    for (std::size_t v = 0; v < kVectors; ++v) {
      Vec<T>* one = sum[v] + p * kCount;  // W, E_a; or W, P_a, Q
      for (std::size_t a = 0; a < 3; ++a) {
        const Vec<T> shift = hn::Set(d, pairs[p].move[a]);
        Vec<T>& moment = one[kTransposed ? 4 : 1 + a];
        moment = hn::MulAdd(shift, one[kTransposed ? 1 + a : 0], moment);
      }
      for (std::size_t c = 0; c < kCount; ++c) {
        T* at = pairs[p].to + Route::to(c) * distance + row + v * hn::Lanes(d);
        hn::Store(hn::Add(one[c], hn::Load(d, at)), d, at);
      }
    }
  }
}

template <class T, bool kTransposed, bool kWeighted>
void TranslateStokesPairs(const TranslationMatrix<T>& matrix, const Translation<T>* pairs, std::size_t count, std::size_t distance) {
  ForRows<T>(matrix.rows, [&](auto vectors, std::size_t row) HWY_ATTR {
    std::size_t i = 0;
    for (; i + 2 <= count; i += 2) StokesPairsTile<T, vectors, 2, kTransposed, kWeighted>(matrix, row, pairs + i, distance);
    if (i < count) StokesPairsTile<T, vectors, 1, kTransposed, kWeighted>(matrix, row, pairs + i, distance);
  });
}

template <class T, bool kTransposed>
void TranslateStokesPairs(const TranslationMatrix<T>& matrix, const Translation<T>* pairs, std::size_t count, std::size_t channels,
                          std::size_t distance) {
  if (channels == kStokesMultipoles) return TranslateStokesPairs<T, kTransposed, false>(matrix, pairs, count, distance);
  TranslateStokesPairs<T, kTransposed, true>(matrix, pairs, count, distance);
}

template <class T>
void Translate(const TranslationMatrix<T>& matrix, const Translation<T>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  switch (moved) {
    case Moved::kStokes:
      static_assert(kStokesLocals == kStokesMultipoles + 1);
      if (channels == kStokesMultipoles) return TranslateStokes<T, kStokesMultipoles>(matrix, translations, count, distance);
      if (channels == kStokesLocals) return TranslateStokes<T, kStokesLocals>(matrix, translations, count, distance);
      return TranslateStokes<T, kStokesLocals + 1>(matrix, translations, count, distance);
    case Moved::kStokesForward:
      return TranslateStokesPairs<T, false>(matrix, translations, count, channels, distance);
    case Moved::kStokesTransposed:
      return TranslateStokesPairs<T, true>(matrix, translations, count, channels, distance);
    case Moved::kAll:
      break;
  }
  constexpr std::size_t kBatch = 64;  // expansions; all channels of a translation, whatever their number
  const T* from[kBatch];
  T* to[kBatch];
  for (std::size_t i = 0; i < count;) {
    std::size_t size = 0;
    for (; i < count && size + channels <= kBatch; ++i) {
      for (std::size_t c = 0; c < channels; ++c, ++size) {
        from[size] = translations[i].from + c * distance;
        to[size] = translations[i].to + c * distance;
      }
    }
    ForRows<T>(matrix.rows, [&](auto vectors, std::size_t row) HWY_ATTR { TranslateRows<T, vectors>(matrix, row, from, to, size); });
  }
}

void PointsToMultipoleFloat(const LeafTask<float>& task) { PointsToMultipole(task); }
void PointsToMultipoleDouble(const LeafTask<double>& task) { PointsToMultipole(task); }
void LocalToPointsFloat(const LeafTask<float>& task) { LocalToPoints(task); }
void LocalToPointsDouble(const LeafTask<double>& task) { LocalToPoints(task); }
void TranslateFloat(const TranslationMatrix<float>& matrix, const Translation<float>* translations, std::size_t count, std::size_t channels,
                    std::size_t distance, Moved moved) {
  Translate(matrix, translations, count, channels, distance, moved);
}
void TranslateDouble(const TranslationMatrix<double>& matrix, const Translation<double>* translations, std::size_t count,
                     std::size_t channels, std::size_t distance, Moved moved) {
  Translate(matrix, translations, count, channels, distance, moved);
}

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace g3r::cpu {

HWY_EXPORT(PointsToMultipoleFloat);
HWY_EXPORT(PointsToMultipoleDouble);
HWY_EXPORT(LocalToPointsFloat);
HWY_EXPORT(LocalToPointsDouble);
HWY_EXPORT(TranslateFloat);
HWY_EXPORT(TranslateDouble);

// P2M: basis, accumulators and fields of one vector of sources. L2P (channels = 1): basis and one expansion.
std::size_t leaf_workspace(std::size_t coefficients, std::size_t channels) {
  return (coefficients * (1 + channels) + kMostFields) * kLanes;
}

void points_to_multipole(const LeafTask<float>& task) { HWY_DYNAMIC_DISPATCH(PointsToMultipoleFloat)(task); }
void points_to_multipole(const LeafTask<double>& task) { HWY_DYNAMIC_DISPATCH(PointsToMultipoleDouble)(task); }
void local_to_points(const LeafTask<float>& task) { HWY_DYNAMIC_DISPATCH(LocalToPointsFloat)(task); }
void local_to_points(const LeafTask<double>& task) { HWY_DYNAMIC_DISPATCH(LocalToPointsDouble)(task); }
void translate(const TranslationMatrix<float>& matrix, const Translation<float>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  HWY_DYNAMIC_DISPATCH(TranslateFloat)(matrix, translations, count, channels, distance, moved);
}
void translate(const TranslationMatrix<double>& matrix, const Translation<double>* translations, std::size_t count, std::size_t channels,
               std::size_t distance, Moved moved) {
  HWY_DYNAMIC_DISPATCH(TranslateDouble)(matrix, translations, count, channels, distance, moved);
}

}  // namespace g3r::cpu
#endif
