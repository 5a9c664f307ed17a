// The operators on an engine: how the values of the sources are filled, and what becomes of the sums. Formulas and signs: direct_sum.h.
// Internal to src/sum.
#pragma once

#include "base/vector.h"
#include "cpu/parallel.h"
#include "kernels/kernels.h"
#include "sum/harmonic_values.h"
#include "sum/sum_engine.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::sum_operators {

inline constexpr std::array<std::size_t, 3> kBatches{1, 4, 9};  // harmonics per sweep that have a kernel; others are padded with zeros

using cpu::kLanes;
using cpu::NearForm;
using vector::dot;

// Calls use(first harmonic, harmonics, kernel batch) until all `count` are done.
template <class Use>
void for_batches(std::size_t count, const Use& use) {
  for (std::size_t first = 0; first < count;) {
    const std::size_t rest = std::min(count - first, kBatches.back());
    const std::size_t batch = *std::lower_bound(kBatches.begin(), kBatches.end(), rest);
    use(first, rest, batch);
    first += rest;
  }
}

// Hands the sums of an engine to use(point, its first channel); channels of one target are kLanes apart.
template <class Use>
auto each_of(std::size_t channels, const Use& use) {
  return [channels, &use](std::uint32_t first, std::uint32_t count, const double* sums) {
    for (std::uint32_t i = 0; i < count; ++i) use(first + i, sums + i / kLanes * channels * kLanes + i % kLanes);
  };
}

template <class T>
void fill_eta(SumEngine<T>& engine, const std::vector<Vec3>& eta, std::size_t values, const std::vector<double>& factor = {}) {
  engine.begin_values(values);
  parallel::for_blocks(eta.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a) {
      T* value = engine.value(a);
      for (std::size_t i = begin; i < end; ++i) value[i] = static_cast<T>(factor.empty() ? eta[i][a] : factor[i] * eta[i][a]);
    }
  });
}

template <class T>
void green_into(SumEngine<T>& engine, const HarmonicValues& u, const std::vector<Vec3>& eta, std::vector<double>& out) {
  for_batches(u.count, [&](std::size_t first, std::size_t count, std::size_t batch) {
    fill_eta(engine, eta, 3 + 2 * batch);
    parallel::for_blocks(eta.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = 0; k < batch; ++k) {
        T* monopole = engine.value(3 + 2 * k);
        T* dipole = engine.value(4 + 2 * k);
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t source = i * u.count + first + k;
          monopole[i] = k < count ? static_cast<T>(dot(u.gradient[source], eta[i])) : T{0};
          dipole[i] = k < count ? static_cast<T>(u.value[source]) : T{0};
        }
      }
    });
    const auto keep = [&](std::size_t p, const double* value) {
      for (std::size_t k = 0; k < count; ++k) out[p * u.count + first + k] = kInv4Pi * value[k * kLanes];
    };
    engine.run(NearForm::kGreen, static_cast<int>(batch), batch, each_of(batch, keep));
  });
}

template <class T>
void green_adjoint_into(SumEngine<T>& engine, const HarmonicValues& u, const std::vector<double>& q, std::vector<Vec3>& out) {
  for_batches(u.count, [&](std::size_t first, std::size_t count, std::size_t batch) {
    engine.begin_values(batch);
    parallel::for_blocks(out.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = 0; k < batch; ++k) {
        T* value = engine.value(k);
        for (std::size_t j = begin; j < end; ++j) value[j] = k < count ? static_cast<T>(q[j * u.count + first + k]) : T{0};
      }
    });
    engine.begin_target_values(batch);
    parallel::for_blocks(out.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = 0; k < batch; ++k) {
        T* value = engine.target_value(k);
        for (std::size_t j = begin; j < end; ++j) value[j] = k < count ? static_cast<T>(u.value[j * u.count + first + k]) : T{0};
      }
    });
    const auto add = [&](std::size_t p, const double* value) {
      for (std::size_t a = 0; a < 3; ++a) {
        double sum = -value[(batch + a) * kLanes];  // the kernel sums g (x - y), the formula wants g (y - x)
        for (std::size_t k = 0; k < count; ++k) sum += value[k * kLanes] * u.gradient[p * u.count + first + k][a];
        out[p][a] += kInv4Pi * sum;
      }
    };
    engine.run(NearForm::kGreenAdjoint, static_cast<int>(batch), batch + 3, each_of(batch + 3, add));
  });
}

template <class T>
void stokes_winding_into(SumEngine<T>& engine, const std::vector<Vec3>& eta, const std::vector<double>& factor, std::vector<Vec3>& s,
                         std::vector<double>& w) {
  fill_eta(engine, eta, 3, factor);
  const auto keep = [&](std::size_t p, const double* value) {
    for (std::size_t a = 0; a < 3; ++a) s[p][a] = kInv4Pi * value[a * kLanes];
    w[p] = kInv4Pi * value[3 * kLanes];
  };
  engine.run(NearForm::kStokesWinding, 1, 4, each_of(4, keep));
}

template <class T>
void winding_gradient_into(SumEngine<T>& engine, std::vector<Vec3>& out) {
  const auto keep = [&](std::size_t p, const double* value) {
    for (std::size_t a = 0; a < 3; ++a) out[p][a] = kInv4Pi * value[a * kLanes];
  };
  engine.run(NearForm::kWindingGradient, 1, 3, each_of(3, keep));
}

template <class T>
void winding_into(SumEngine<T>& engine, std::vector<double>& out) {
  const auto keep = [&](std::size_t p, const double* value) { out[p] = kInv4Pi * value[0]; };
  engine.run(NearForm::kWinding, 1, 1, each_of(1, keep));
}

// use(point, axis, component of W^T q)
template <class T, class Use>
void winding_adjoint_into(SumEngine<T>& engine, const std::vector<double>& q, const Use& use) {
  engine.begin_values(1);
  T* charge = engine.value(0);
  parallel::for_all(q.size(), [&](std::size_t i) { charge[i] = static_cast<T>(q[i]); });
  const auto keep = [&](std::size_t p, const double* value) {
    for (std::size_t a = 0; a < 3; ++a) use(p, a, -kInv4Pi * value[a * kLanes]);  // the kernel sums g (x - y), the formula wants g (y - x)
  };
  engine.run(NearForm::kWindingAdjoint, 1, 3, each_of(3, keep));
}

}  // namespace g3r::sum_operators
