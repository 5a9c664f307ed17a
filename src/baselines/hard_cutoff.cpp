#include "baselines/hard_cutoff.h"

#include "base/vector.h"
#include "cpu/parallel.h"
#include "kernels/kernels.h"

#include <algorithm>

namespace g3r {
namespace {

double kernel_reach(const SumPlan& plan) { return plan.double_precision ? kMollifierReach<double> : kMollifierReach<float>; }

// The Gaussian whose kernels are the plain ones from `width` on.
double gaussian_width(double width, const SumPlan& plan) { return width / kernel_reach(plan); }

// What is taken off pair by pair must have been summed as such.
SumPlan with_whole_kernel(SumPlan plan) {
  plan.reach = kernel_reach(plan);
  return plan;
}

}  // namespace

HardCutoffSum::HardCutoffSum(const std::vector<Vec3>& points, double width, const SumPlan& plan, const std::atomic<bool>* cancel)
    : points_(points),
      width_(width),
      sum_(points, Widths(gaussian_width(width, plan)), with_whole_kernel(plan), cancel),
      near_(near_pairs(points, width, cancel)) {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double share = static_cast<double>(i) / kIntervals;
    const KernelValues kernels = mollified_kernels(share * width * width, gaussian_width(width, plan));
    table_[i] = {kernels.double_layer, kernels.gradient};
  }
}

HardCutoffSum::Kernels HardCutoffSum::mollified(double squared_distance) const {
  const double at = squared_distance / (width_ * width_) * kIntervals;
  const std::size_t i = std::min(static_cast<std::size_t>(at), kIntervals);
  const double t = at - static_cast<double>(i);
  const Kernels& low = table_[i];
  const Kernels& high = table_[i + 1];
  return {low.g + t * (high.g - low.g), low.b + t * (high.b - low.b)};
}

template <class Use>
void HardCutoffSum::for_near(const Use& use) const {
  parallel::for_blocks(points_.size(), parallel::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = near_.first[i]; k < near_.first[i + 1]; ++k) {
        const std::size_t j = near_.other[k];
        const Vec3 r = vector::subtract(points_[j], points_[i]);
        use(i, j, r, mollified(vector::dot(r, r)));
      }
    }
  });
}

// (W eta)_i = sum_j g r . eta_j, r = y_j - x_i
std::vector<double> HardCutoffSum::winding(const std::vector<Vec3>& eta) {
  std::vector<double> w = sum_.winding(eta);
  for_near([&](std::size_t i, std::size_t j, const Vec3& r, const Kernels& kernels) { w[i] -= kernels.g * vector::dot(r, eta[j]); });
  return w;
}

// (W^T q)_i = sum_j q_j g (y_i - x_j) = -sum_j q_j g r
std::vector<Vec3> HardCutoffSum::winding_adjoint(const std::vector<double>& q) {
  std::vector<Vec3> out = sum_.winding_adjoint(q);
  for_near([&](std::size_t i, std::size_t j, const Vec3& r, const Kernels& kernels) {
    out[i] = vector::add(out[i], vector::scale(r, kernels.g * q[j]));
  });
  return out;
}

// -grad w = sum_j [g eta_j - b r (r . eta_j)]
std::vector<Vec3> HardCutoffSum::winding_gradient(const std::vector<Vec3>& eta) {
  std::vector<Vec3> out = sum_.winding_gradient(eta);
  for_near([&](std::size_t i, std::size_t j, const Vec3& r, const Kernels& kernels) {
    const Vec3 across = vector::scale(r, kernels.b * vector::dot(r, eta[j]));
    out[i] = vector::subtract(out[i], vector::subtract(vector::scale(eta[j], kernels.g), across));
  });
  return out;
}

}  // namespace g3r
