#include "sum/fast_sum.h"

#include "cloud/canonical_cloud.h"
#include "sum/device_scope.h"
#include "sum/solve_on_device.h"
#include "sum/sum_operators.h"
#include "sum/target_shells.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <variant>

namespace g3r {
namespace {

using namespace sum_operators;
using target_shells::kNoShell, target_shells::kShells, target_shells::scaled, target_shells::sort_canonically;

constexpr std::size_t kTargetsAtOnce = 1 << 17;  // of queries: what a sum holds per target is 330 bytes. Fewer: each chunk costs lists
// Of targets outside the cube, and of derivatives there: with fewer terms they err by percents, as nothing near outweighs what was cut off.
// More take matrices of 17 MB instead of 3.
constexpr double kShellAccuracy = 1e-4;
constexpr double kShellGradientAccuracy = 1e-5;

double widest(const Widths& widths) { return *std::max_element(widths.values.begin(), widths.values.end()); }

// Sums run on the device of their plan, or else of their surroundings.
SumPlan placed(SumPlan plan) {
  if (!plan.execution) plan.execution = gpu::Scope::current();
  return plan;
}

}  // namespace

struct FastSum::Impl {
  const std::vector<Vec3>* points;
  double width;  // the largest
  SumPlan plan;
  const std::atomic<bool>* cancel;
  std::variant<SumEngine<float>, SumEngine<double>> engine;

  using Engine = decltype(engine);
  static Engine make(const std::vector<Vec3>& points, const Widths& widths, const SumPlan& plan, const std::atomic<bool>* cancel) {
    if (plan.double_precision) return Engine(std::in_place_type<SumEngine<double>>, points, widths, plan, cancel);
    return Engine(std::in_place_type<SumEngine<float>>, points, widths, plan, cancel);
  }

  // The sources with all lengths times `factor`, a power of two: their order stays. For targets outside the cube, which only the widest
  // kernels reach.
  [[nodiscard]] Engine shrunk(double factor, const SumPlan& with, const std::atomic<bool>* stop) const {
    return make(scaled(*points, factor), Widths(factor * width), with, stop);
  }

  // The plan of the sums, of this accuracy at least.
  [[nodiscard]] SumPlan finer(double accuracy) const {
    SumPlan finer = sum_plan(accuracy, points->size());
    finer.execution = plan.execution;
    return plan.order < finer.order ? finer : plan;
  }

  // Sums of `eta` at any targets. Everything is shrunk until the targets are in the cube: one sum for every shell that has some.
  // `fast(engine for some targets, their order, factor)`: lengths are `factor` times as long as the caller's. `direct(targets, their
  // order)`: outside the cube where sums are direct anyway, or a shell's kernels would be too narrow. `outside`: of the shells.
  template <class Fast, class Direct>
  void at(const std::vector<Vec3>& eta, const std::vector<Vec3>& targets, const SumPlan& outside, const std::atomic<bool>* stop,
          const Fast& fast, const Direct& direct) const {
    std::array<std::vector<std::uint32_t>, kShells + 1> members = target_shells::members(targets, width, !plan.direct);
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
        std::visit(sum_on, shrunk(factor, outside, stop));
      }
      std::vector<std::uint32_t>().swap(index);
    }
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
  impl_.reset(new Impl{&points, widest(widths), placed(plan), cancel, Impl::make(points, widths, placed(plan), cancel)});
}

FastSum::FastSum(const FastSum& other, const Widths& narrower) {
  const Impl& from = *other.impl_;
  impl_.reset(new Impl{
      from.points, widest(narrower), from.plan, from.cancel,
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

std::unique_ptr<SolveVectors> FastSum::energy_vectors(double damping, double winding_weight, const std::vector<double>& roots) {
  const EnergyTerms terms{damping, winding_weight, roots};
  return std::visit([&](auto& engine) { return g3r::energy_vectors(engine, size(), terms); }, impl_->engine);
}

std::unique_ptr<SolveVectors> FastSum::green_vectors(const HarmonicValues& u) {
  return std::visit([&](auto& engine) { return g3r::green_vectors(engine, size(), u); }, impl_->engine);
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
      etas.front(), targets, impl_->finer(kShellAccuracy), cancel,
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
      eta, targets, impl_->finer(kShellGradientAccuracy), cancel,
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
