#include "sum/fast_sum.h"

#include "cloud/canonical_cloud.h"
#include "cpu/parallel.h"
#include "sum/kernels.h"
#include "sum/sum_engine.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace g3r {
namespace {

constexpr std::size_t kBlock = 1024;                     // points per parallel block
constexpr std::array<std::size_t, 3> kBatches{1, 4, 9};  // harmonics per sweep that have a kernel; others are padded with zeros

using cpu::kLanes;
using cpu::NearForm;

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

// Calls use(point, lane's first channel) for every target once; channels of one target are kLanes apart.
template <class T, class Use>
void for_targets(const TargetBlocks<T>& targets, const std::vector<double>& out, std::size_t channels, const Use& use) {
  parallel::for_blocks(targets.point.size() / kLanes, kBlock / kLanes, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t at = block * kLanes + lane;
        if (lane > 0 && targets.point[at] == targets.point[at - 1]) break;  // the padded tail
        use(targets.point[at], out.data() + block * channels * kLanes + lane);
      }
    }
  });
}

template <class T>
void fill_eta(SumEngine<T>& engine, const std::vector<Vec3>& eta, std::size_t values) {
  engine.begin_values(values);
  parallel::for_blocks(eta.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = 0; a < 3; ++a) {
      T* value = engine.value(a);
      for (std::size_t i = begin; i < end; ++i) value[i] = static_cast<T>(eta[i][a]);
    }
  });
}

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

template <class T>
void green_into(SumEngine<T>& engine, const HarmonicValues& u, const std::vector<Vec3>& eta, std::vector<double>& out) {
  for_batches(u.count, [&](std::size_t first, std::size_t count, std::size_t batch) {
    fill_eta(engine, eta, 3 + 2 * batch);
    parallel::for_blocks(eta.size(), kBlock, [&](std::size_t begin, std::size_t end) {
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
    const auto& sums = engine.run(NearForm::kGreen, static_cast<int>(batch), batch);
    for_targets(engine.targets(), sums, batch, [&](std::size_t p, const double* value) {
      for (std::size_t k = 0; k < count; ++k) out[p * u.count + first + k] = kInv4Pi * value[k * kLanes];
    });
  });
}

template <class T>
void green_adjoint_into(SumEngine<T>& engine, const HarmonicValues& u, const std::vector<double>& q, std::vector<Vec3>& out) {
  for_batches(u.count, [&](std::size_t first, std::size_t count, std::size_t batch) {
    engine.begin_values(batch);
    parallel::for_blocks(out.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = 0; k < batch; ++k) {
        T* value = engine.value(k);
        for (std::size_t j = begin; j < end; ++j) value[j] = k < count ? static_cast<T>(q[j * u.count + first + k]) : T{0};
      }
    });
    AlignedVector<T>& data = engine.target_data(batch);
    const std::vector<std::uint32_t>& point = engine.targets().point;
    parallel::for_blocks(point.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t lane = begin; lane < end; ++lane) {
        for (std::size_t k = 0; k < batch; ++k) {
          data[(lane / kLanes * batch + k) * kLanes + lane % kLanes] =
              k < count ? static_cast<T>(u.value[point[lane] * u.count + first + k]) : T{0};
        }
      }
    });
    const auto& sums = engine.run(NearForm::kGreenAdjoint, static_cast<int>(batch), batch + 3);
    for_targets(engine.targets(), sums, batch + 3, [&](std::size_t p, const double* value) {
      for (std::size_t a = 0; a < 3; ++a) {
        double sum = -value[(batch + a) * kLanes];  // the kernel sums g (x - y), the formula wants g (y - x)
        for (std::size_t k = 0; k < count; ++k) sum += value[k * kLanes] * u.gradient[p * u.count + first + k][a];
        out[p][a] += kInv4Pi * sum;
      }
    });
  });
}

template <class T>
void stokes_winding_into(SumEngine<T>& engine, const std::vector<Vec3>& eta, std::vector<Vec3>& s, std::vector<double>& w) {
  fill_eta(engine, eta, 3);
  const auto& sums = engine.run(NearForm::kStokesWinding, 1, 4);
  for_targets(engine.targets(), sums, 4, [&](std::size_t p, const double* value) {
    for (std::size_t a = 0; a < 3; ++a) s[p][a] = kInv4Pi * value[a * kLanes];
    w[p] = kInv4Pi * value[3 * kLanes];
  });
}

template <class T>
void winding_gradient_into(SumEngine<T>& engine, const std::vector<Vec3>& eta, std::vector<Vec3>& out) {
  fill_eta(engine, eta, 3);
  const auto& sums = engine.run(NearForm::kWindingGradient, 1, 3);
  for_targets(engine.targets(), sums, 3, [&](std::size_t p, const double* value) {
    for (std::size_t a = 0; a < 3; ++a) out[p][a] = kInv4Pi * value[a * kLanes];
  });
}

// The harmonic u = 1 at n points.
HarmonicValues constant_harmonic(std::size_t n) {
  HarmonicValues u;
  u.count = 1;
  u.value.assign(n, 1.0);
  u.gradient.assign(n, Vec3{0, 0, 0});
  return u;
}

bool in_cube(const Vec3& p) { return std::abs(p[0]) <= 1 && std::abs(p[1]) <= 1 && std::abs(p[2]) <= 1; }  // not if any is NaN

}  // namespace

struct FastSum::Impl {
  std::vector<Vec3> points;
  Widths widths;
  SumPlan plan;
  const std::atomic<bool>* cancel;
  std::variant<SumEngine<float>, SumEngine<double>> engine;

  using Engine = decltype(engine);
  static Engine make(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, const Widths& widths, const SumPlan& plan,
                     const std::atomic<bool>* cancel) {
    if (plan.double_precision) return Engine(std::in_place_type<SumEngine<double>>, points, morton, widths, plan, cancel);
    return Engine(std::in_place_type<SumEngine<float>>, points, morton, widths, plan, cancel);
  }

  // Runs `inside(engine for these targets, their canonical order)` on targets in the cube, `outside(targets)` on the others.
  template <class Inside, class Outside>
  void at(const std::vector<Vec3>& targets, const std::atomic<bool>* stop, const Inside& inside, const Outside& outside) const {
    std::vector<std::uint32_t> index_in;
    std::vector<std::uint32_t> index_out;
    for (std::uint32_t i = 0; i < targets.size(); ++i) (in_cube(targets[i]) ? index_in : index_out).push_back(i);
    if (!index_in.empty()) {
      std::vector<Vec3> sorted(index_in.size());
      for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = targets[index_in[i]];
      const MortonOrder order = morton_order(sorted);
      std::vector<std::uint32_t> index(sorted.size());
      for (std::size_t i = 0; i < sorted.size(); ++i) {
        index[i] = index_in[order.index[i]];
        sorted[i] = targets[index[i]];
      }
      std::visit(
          [&](const auto& own) {
            std::decay_t<decltype(own)> engine_at(own, sorted, order.code, stop);
            inside(engine_at, index);
          },
          engine);
    }
    if (!index_out.empty()) {
      std::vector<Vec3> far(index_out.size());
      for (std::size_t i = 0; i < far.size(); ++i) far[i] = targets[index_out[i]];
      outside(far, index_out);
    }
  }
};

FastSum::FastSum(const std::vector<Vec3>& points, const std::vector<std::uint64_t>& morton, Widths widths, const SumPlan& plan,
                 const std::atomic<bool>* cancel)
    : impl_(new Impl{points, widths, plan, cancel, Impl::make(points, morton, widths, plan, cancel)}) {}

FastSum::~FastSum() = default;
FastSum::FastSum(FastSum&&) noexcept = default;
FastSum& FastSum::operator=(FastSum&&) noexcept = default;

std::size_t FastSum::size() const { return impl_->points.size(); }
const SumPlan& FastSum::plan() const { return impl_->plan; }

std::vector<double> FastSum::green(const HarmonicValues& u, const std::vector<Vec3>& eta) {
  std::vector<double> out(size() * u.count);
  std::visit([&](auto& engine) { green_into(engine, u, eta, out); }, impl_->engine);
  return out;
}

std::vector<Vec3> FastSum::green_adjoint(const HarmonicValues& u, const std::vector<double>& q) {
  std::vector<Vec3> out(size(), Vec3{0, 0, 0});
  std::visit([&](auto& engine) { green_adjoint_into(engine, u, q, out); }, impl_->engine);
  return out;
}

void FastSum::stokes_winding(const std::vector<Vec3>& eta, std::vector<Vec3>& s, std::vector<double>& w) {
  s.resize(size());
  w.resize(size());
  std::visit([&](auto& engine) { stokes_winding_into(engine, eta, s, w); }, impl_->engine);
}

std::vector<Vec3> FastSum::winding_adjoint(const std::vector<double>& q) { return green_adjoint(constant_harmonic(size()), q); }

std::vector<double> FastSum::winding(const std::vector<Vec3>& eta) { return green(constant_harmonic(size()), eta); }

std::vector<Vec3> FastSum::winding_gradient(const std::vector<Vec3>& eta) {
  std::vector<Vec3> out(size());
  std::visit([&](auto& engine) { winding_gradient_into(engine, eta, out); }, impl_->engine);
  return out;
}

std::vector<double> FastSum::winding_at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                                        const std::atomic<bool>* cancel) const {
  std::vector<double> out(targets.size());
  impl_->at(
      targets, cancel,
      [&](auto& engine, const std::vector<std::uint32_t>& index) {
        std::vector<double> sorted(index.size());
        green_into(engine, constant_harmonic(size()), eta, sorted);
        for (std::size_t i = 0; i < index.size(); ++i) out[index[i]] = sorted[i];
      },
      [&](const std::vector<Vec3>& far, const std::vector<std::uint32_t>& index) {
        const std::vector<double> w = direct_sum::winding(impl_->points, impl_->widths[0], eta, far, cancel);
        for (std::size_t i = 0; i < index.size(); ++i) out[index[i]] = w[i];
      });
  return out;
}

std::vector<Vec3> FastSum::winding_gradient_at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                                               const std::atomic<bool>* cancel) const {
  std::vector<Vec3> out(targets.size());
  impl_->at(
      targets, cancel,
      [&](auto& engine, const std::vector<std::uint32_t>& index) {
        std::vector<Vec3> sorted(index.size());
        winding_gradient_into(engine, eta, sorted);
        for (std::size_t i = 0; i < index.size(); ++i) out[index[i]] = sorted[i];
      },
      [&](const std::vector<Vec3>& far, const std::vector<std::uint32_t>& index) {
        const std::vector<Vec3> g = direct_sum::winding_gradient(impl_->points, impl_->widths[0], eta, far, cancel);
        for (std::size_t i = 0; i < index.size(); ++i) out[index[i]] = g[i];
      });
  return out;
}

}  // namespace g3r
