// L2P: the sums at the targets of leaves from local expansions. Highway compiles this file once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/local_to_points.cpp"
#include "cpu/far_field.h"

#include "kernels/expansion_index.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "cpu/regular_harmonics.h"  // NOLINT(llvm-include-order): anew for every instruction set

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

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

void LocalToPointsFloat(const LeafTask<float>& task) { LocalToPoints(task); }
void LocalToPointsDouble(const LeafTask<double>& task) { LocalToPoints(task); }

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace g3r::cpu {

HWY_EXPORT(LocalToPointsFloat);
HWY_EXPORT(LocalToPointsDouble);

void local_to_points(const LeafTask<float>& task) { HWY_DYNAMIC_DISPATCH(LocalToPointsFloat)(task); }
void local_to_points(const LeafTask<double>& task) { HWY_DYNAMIC_DISPATCH(LocalToPointsDouble)(task); }

}  // namespace g3r::cpu
#endif
