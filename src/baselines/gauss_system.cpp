#include "baselines/gauss_system.h"

#include "base/vector.h"

namespace g3r {
namespace {

void add_to(std::vector<Vec3>& sum, const std::vector<Vec3>& term) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = vector::add(sum[i], term[i]);
}

}  // namespace

GaussSystem::GaussSystem(const std::vector<Vec3>& points, const std::vector<Vec3>& stretches, double epsilon, double damping,
                         const SumPlan& plan, const std::atomic<bool>* cancel)
    : size_(points.size()), damping_(damping) {
  for (const Vec3& stretch : stretches) {
    StretchedWinding winding(points, stretch, epsilon, plan, cancel);
    std::vector<double> weights = winding.row_norms();
    for (double& v : weights) v = 1 / v;
    rows_.push_back({std::move(winding), std::move(weights)});
  }
}

void GaussSystem::apply(const std::vector<Vec3>& eta, std::vector<Vec3>& out) {
  out.resize(size_);
  for (std::size_t i = 0; i < size_; ++i) out[i] = vector::scale(eta[i], damping_);
  for (Rows& rows : rows_) {
    std::vector<double> w = rows.winding.apply(eta);
    for (std::size_t i = 0; i < size_; ++i) w[i] *= rows.weights[i];
    add_to(out, rows.winding.adjoint(w));
  }
}

std::vector<Vec3> GaussSystem::right_side() {
  std::vector<Vec3> out(size_, Vec3{0, 0, 0});
  for (Rows& rows : rows_) {
    std::vector<double> half(rows.weights);
    for (double& v : half) v *= 0.5;
    add_to(out, rows.winding.adjoint(half));
  }
  return out;
}

}  // namespace g3r
