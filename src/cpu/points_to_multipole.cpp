// P2M: the multipoles of leaves from their sources. Highway compiles this file once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/points_to_multipole.cpp"
#include "cpu/far_field.h"

#include "kernels/expansion_index.h"

#include <cstring>

#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "cpu/regular_harmonics.h"  // NOLINT(llvm-include-order): anew for every instruction set

HWY_BEFORE_NAMESPACE();
namespace g3r::cpu::HWY_NAMESPACE {

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

void PointsToMultipoleFloat(const LeafTask<float>& task) { PointsToMultipole(task); }
void PointsToMultipoleDouble(const LeafTask<double>& task) { PointsToMultipole(task); }

}  // namespace g3r::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace g3r::cpu {

HWY_EXPORT(PointsToMultipoleFloat);
HWY_EXPORT(PointsToMultipoleDouble);

// P2M: basis, accumulators and fields of one vector of sources. L2P (channels = 1): basis and one expansion.
std::size_t leaf_workspace(std::size_t coefficients, std::size_t channels) {
  return (coefficients * (1 + channels) + kMostFields) * kLanes;
}

void points_to_multipole(const LeafTask<float>& task) { HWY_DYNAMIC_DISPATCH(PointsToMultipoleFloat)(task); }
void points_to_multipole(const LeafTask<double>& task) { HWY_DYNAMIC_DISPATCH(PointsToMultipoleDouble)(task); }

}  // namespace g3r::cpu
#endif
