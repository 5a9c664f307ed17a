#include "sum/fast_sum.h"

#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "cpu/parallel.h"
#include "kernels/kernels.h"
#include "sum/device_scope.h"
#include "sum/sum_engine.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <variant>

namespace g3r {
namespace {

using vector::dot;

constexpr std::size_t kTargetsAtOnce = 1 << 17;  // of queries: what a sum holds per target is 330 bytes. Fewer: each chunk costs lists
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

// Sums run on the device of their plan, or else of their surroundings.
SumPlan placed(SumPlan plan) {
  if (!plan.execution) plan.execution = gpu::Scope::current();
  return plan;
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

constexpr double kShellAccuracy = 1e-5;  // with fewer terms their derivatives err by percents: nothing near outweighs what was cut off
// Targets outside the cube belong to the shell of the smallest power of two, times the cube, that holds them: 2^shell.
constexpr int kShells = 21;           // shells with a sum of their own; the grid has no more levels
constexpr double kLeastWidth = 2e-7;  // of a shell's kernels: the derivative takes 1 / width to the fifth power, which is a float
constexpr int kNoShell = kShells;     // farther, or no number

int shell_of(const Vec3& p) {
  const double far = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  if (far <= 1) return std::isnan(p[0] + p[1] + p[2]) ? kNoShell : 0;
  if (!(far < std::ldexp(1.0, kShells - 1))) return kNoShell;
  int shell = 0;
  std::frexp(far, &shell);
  return shell;
}

std::vector<Vec3> scaled(std::vector<Vec3> points, double factor) {
  for (Vec3& p : points) {
    for (double& c : p) c *= factor;
  }
  return points;
}

}  // namespace

struct FastSum::Impl {
  const std::vector<Vec3>* points;
  double width;  // where it is uniform
  SumPlan plan;
  const std::atomic<bool>* cancel;
  std::variant<SumEngine<float>, SumEngine<double>> engine;

  using Engine = decltype(engine);
  static Engine make(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel) {
    if (plan.double_precision) return Engine(std::in_place_type<SumEngine<double>>, points, widths, plan, cancel);
    return Engine(std::in_place_type<SumEngine<float>>, points, widths, plan, cancel);
  }

  // The sources with all lengths times `factor`, a power of two: their order stays.
  [[nodiscard]] Engine shrunk(double factor, const std::atomic<bool>* stop) const {
    const std::vector<Vec3> sources = scaled(*points, factor);
    SumPlan finer = sum_plan(kShellAccuracy, sources.size());
    finer.execution = plan.execution;
    return make(sources, Widths(factor * width), plan.order < finer.order ? finer : plan, stop);
  }

  // Sums of `eta` at any targets. Everything is shrunk until the targets are in the cube: one sum for every shell that has some.
  // `fast(engine for some targets, their order, factor)`: lengths are `factor` times as long as the caller's. `direct(targets, their
  // order)`: outside the cube where sums are direct anyway, or a shell's kernels would be too narrow.
  template <class Fast, class Direct>
  void at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets, const std::atomic<bool>* stop, const Fast& fast,
          const Direct& direct) const {
    std::array<std::vector<std::uint32_t>, kShells + 1> members;
    for (std::uint32_t i = 0; i < targets.size(); ++i) {
      const int shell = shell_of(targets[i]);
      const bool shrinks = !plan.direct && std::ldexp(width, -shell) >= kLeastWidth;
      members[static_cast<std::size_t>(shell == 0 || shrinks ? shell : kNoShell)].push_back(i);
    }
    for (int shell = 0; shell <= kNoShell; ++shell) {
      std::vector<std::uint32_t>& index = members[static_cast<std::size_t>(shell)];
      if (index.empty()) continue;
      if (shell == kNoShell) {
        std::vector<Vec3> some(index.size());
        for (std::size_t i = 0; i < some.size(); ++i) some[i] = targets[index[i]];
        direct(some, index);
        continue;
      }
      const double factor = std::ldexp(1.0, -shell);
      sort_canonically(targets, factor, index);
      const auto sum_on = [&](const auto& sources) { in_chunks(sources, eta, targets, factor, index, stop, fast); };
      if (shell == 0) {
        std::visit(sum_on, engine);
      } else {
        std::visit(sum_on, shrunk(factor, stop));
      }
      std::vector<std::uint32_t>().swap(index);
    }
  }

  // Puts the targets of `index`, shrunk, into canonical order.
  static void sort_canonically(const std::vector<Vec3>& targets, double factor, std::vector<std::uint32_t>& index) {
    std::vector<Vec3> some(index.size());
    parallel::for_all(some.size(), [&](std::size_t i) { some[i] = targets[index[i]]; });
    std::vector<std::uint32_t> order = morton_order(scaled(std::move(some), factor));
    for (std::uint32_t& i : order) i = index[i];
    index.swap(order);
  }

  // Sums at targets in canonical order, some of them at a time: a value depends on the place of its target alone.
  template <class Sources, class Fast>
  static void in_chunks(const Sources& sources, const std::vector<Vec3>& eta, const std::vector<Vec3>& targets, double factor,
                        const std::vector<std::uint32_t>& index, const std::atomic<bool>* stop, const Fast& fast) {
    std::optional<Sources> engine;
    for (std::size_t begin = 0; begin < index.size(); begin += kTargetsAtOnce) {
      const std::size_t end = std::min(index.size(), begin + kTargetsAtOnce);
      const std::vector<std::uint32_t> chunk(index.data() + begin, index.data() + end);
      std::vector<Vec3> some(chunk.size());
      for (std::size_t i = 0; i < some.size(); ++i) some[i] = targets[chunk[i]];
      some = scaled(std::move(some), factor);
      if (engine) {
        engine->set_targets(some);
      } else {
        engine.emplace(sources, some, stop);
        fill_eta(*engine, eta, 3);
      }
      fast(*engine, chunk, factor);
    }
  }
};

FastSum::FastSum(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel) {
  impl_.reset(new Impl{&points, widths[0], placed(plan), cancel, Impl::make(points, widths, placed(plan), cancel)});
}

FastSum::FastSum(const FastSum& other, const Widths& narrower) {
  const Impl& from = *other.impl_;
  impl_.reset(new Impl{
      from.points, narrower[0], from.plan, from.cancel,
      std::visit([&](const auto& engine) { return Impl::Engine(std::decay_t<decltype(engine)>(engine, narrower)); }, from.engine)});
}

FastSum::~FastSum() = default;
FastSum::FastSum(FastSum&&) noexcept = default;
FastSum& FastSum::operator=(FastSum&&) noexcept = default;

std::size_t FastSum::size() const { return impl_->points->size(); }

double FastSum::width(std::size_t point) const {
  return std::visit([&](const auto& engine) { return engine.source_width(point); }, impl_->engine);
}

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

void FastSum::stokes_winding(const std::vector<Vec3>& eta, std::vector<Vec3>& s, std::vector<double>& w,
                             const std::vector<double>& factor) {
  s.resize(size());
  w.resize(size());
  std::visit([&](auto& engine) { stokes_winding_into(engine, eta, factor, s, w); }, impl_->engine);
}

std::vector<Vec3> FastSum::winding_adjoint(const std::vector<double>& q) {
  std::vector<Vec3> out(size());
  const auto keep = [&](std::size_t p, std::size_t a, double value) { out[p][a] = value; };
  std::visit([&](auto& engine) { winding_adjoint_into(engine, q, keep); }, impl_->engine);
  return out;
}

void FastSum::add_winding_adjoint(const std::vector<double>& q, double weight, std::vector<Vec3>& out) {
  const auto add = [&](std::size_t p, std::size_t a, double value) { out[p][a] += weight * value; };
  std::visit([&](auto& engine) { winding_adjoint_into(engine, q, add); }, impl_->engine);
}

std::vector<double> FastSum::winding(const std::vector<Vec3>& eta) {
  std::vector<double> out(size());
  std::visit(
      [&](auto& engine) {
        fill_eta(engine, eta, 3);
        winding_into(engine, out);
      },
      impl_->engine);
  return out;
}

std::vector<Vec3> FastSum::winding_gradient(const std::vector<Vec3>& eta) {
  std::vector<Vec3> out(size());
  std::visit(
      [&](auto& engine) {
        fill_eta(engine, eta, 3);
        winding_gradient_into(engine, out);
      },
      impl_->engine);
  return out;
}

std::vector<double> FastSum::winding_at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                                        const std::atomic<bool>* cancel) const {
  return std::move(windings_at({eta}, targets, cancel).front());
}

std::vector<std::vector<double>> FastSum::windings_at(const std::vector<std::vector<Vec3>>& etas, const std::vector<Vec3>& targets,
                                                      const std::atomic<bool>* cancel) const {
  std::vector<std::vector<double>> out(etas.size(), std::vector<double>(targets.size()));
  impl_->at(
      etas.front(), targets, cancel,
      [&](auto& engine, const std::vector<std::uint32_t>& index, double factor) {
        std::vector<double> sorted(index.size());
        for (std::size_t h = 0; h < etas.size(); ++h) {
          if (etas.size() > 1) fill_eta(engine, etas[h], 3);
          winding_into(engine, sorted);
          for (std::size_t i = 0; i < index.size(); ++i) out[h][index[i]] = factor * factor * sorted[i];
        }
      },
      [&](const std::vector<Vec3>& far, const std::vector<std::uint32_t>& index) {
        for (std::size_t h = 0; h < etas.size(); ++h) {
          const std::vector<double> w = direct_sum::winding(*impl_->points, impl_->width, etas[h], far, cancel);
          for (std::size_t i = 0; i < index.size(); ++i) out[h][index[i]] = w[i];
        }
      });
  return out;
}

std::vector<Vec3> FastSum::winding_gradient_at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                                               const std::atomic<bool>* cancel) const {
  std::vector<Vec3> out(targets.size());
  impl_->at(
      eta, targets, cancel,
      [&](auto& engine, const std::vector<std::uint32_t>& index, double factor) {
        std::vector<Vec3> sorted(index.size());
        winding_gradient_into(engine, sorted);
        sorted = scaled(std::move(sorted), factor * factor * factor);
        for (std::size_t i = 0; i < index.size(); ++i) out[index[i]] = sorted[i];
      },
      [&](const std::vector<Vec3>& far, const std::vector<std::uint32_t>& index) {
        const std::vector<Vec3> g = direct_sum::winding_gradient(*impl_->points, impl_->width, eta, far, cancel);
        for (std::size_t i = 0; i < index.size(); ++i) out[index[i]] = g[i];
      });
  return out;
}

}  // namespace g3r
