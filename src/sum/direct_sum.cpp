#include "sum/direct_sum.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "kernels/kernels.h"

#include <cmath>

namespace g3r::direct_sum {
namespace {

using vector::dot;
using vector::subtract;

void add_scaled(Vec3& a, double s, const Vec3& b) {
  for (std::size_t k = 0; k < 3; ++k) a[k] += s * b[k];
}

}  // namespace

std::vector<double> green(const std::vector<Vec3>& points, const Widths& widths, const HarmonicValues& u, const std::vector<Vec3>& eta) {
  const std::size_t n = points.size();
  const std::size_t count = u.count;
  std::vector<double> out(n * count, 0.0);
  parallel::for_each(n, [&](std::size_t j) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 r = subtract(points[i], points[j]);
      const KernelValues kernel = mollified_kernels(dot(r, r), std::sqrt(pair_width_squared(widths[i], widths[j])));
      const double flux = kernel.double_layer * dot(r, eta[i]);
      for (std::size_t k = 0; k < count; ++k) {
        out[j * count + k] += kernel.single_layer * dot(u.gradient[i * count + k], eta[i]) + u.value[i * count + k] * flux;
      }
    }
  });
  return out;
}

std::vector<Vec3> green_adjoint(const std::vector<Vec3>& points, const Widths& widths, const HarmonicValues& u,
                                const std::vector<double>& q) {
  const std::size_t n = points.size();
  const std::size_t count = u.count;
  std::vector<Vec3> out(n, Vec3{0, 0, 0});
  parallel::for_each(n, [&](std::size_t i) {
    for (std::size_t j = 0; j < n; ++j) {
      const Vec3 r = subtract(points[i], points[j]);
      const KernelValues kernel = mollified_kernels(dot(r, r), std::sqrt(pair_width_squared(widths[i], widths[j])));
      for (std::size_t k = 0; k < count; ++k) {
        const double charge = q[j * count + k];
        add_scaled(out[i], charge * kernel.single_layer, u.gradient[i * count + k]);
        add_scaled(out[i], charge * kernel.double_layer * u.value[i * count + k], r);
      }
    }
  });
  return out;
}

std::vector<Vec3> stokes_single_layer(const std::vector<Vec3>& points, const Widths& widths, const std::vector<Vec3>& eta) {
  const std::size_t n = points.size();
  std::vector<Vec3> out(n, Vec3{0, 0, 0});
  parallel::for_each(n, [&](std::size_t j) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 r = subtract(points[i], points[j]);
      const double e2 = pair_width_squared(widths[i], widths[j]);
      const KernelValues kernel = mollified_kernels(dot(r, r), std::sqrt(e2));
      add_scaled(out[j], kernel.single_layer + e2 * kernel.double_layer, eta[i]);
      add_scaled(out[j], kernel.stokeslet * dot(r, eta[i]), r);
    }
  });
  return out;
}

std::vector<double> winding(const std::vector<Vec3>& points, double width, const std::vector<Vec3>& eta, const std::vector<Vec3>& targets,
                            const std::atomic<bool>* cancel) {
  std::vector<double> out(targets.size(), 0.0);
  const auto sum_at = [&](std::size_t j) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 r = subtract(points[i], targets[j]);
      out[j] += mollified_kernels(dot(r, r), width).double_layer * dot(r, eta[i]);
    }
  };
  parallel::for_each(targets.size(), sum_at, cancel);
  return out;
}

std::vector<Vec3> winding_gradient(const std::vector<Vec3>& points, double width, const std::vector<Vec3>& eta,
                                   const std::vector<Vec3>& targets, const std::atomic<bool>* cancel) {
  std::vector<Vec3> out(targets.size(), Vec3{0, 0, 0});
  const auto sum_at = [&](std::size_t j) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 r = subtract(points[i], targets[j]);
      const KernelValues kernel = mollified_kernels(dot(r, r), width);
      add_scaled(out[j], kernel.double_layer, eta[i]);
      add_scaled(out[j], -kernel.gradient * dot(r, eta[i]), r);
    }
  };
  parallel::for_each(targets.size(), sum_at, cancel);
  return out;
}

}  // namespace g3r::direct_sum
