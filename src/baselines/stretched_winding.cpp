#include "baselines/stretched_winding.h"

#include "base/vector.h"
#include "baselines/near_pairs.h"
#include "cloud/morton.h"
#include "kernels/kernels.h"

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

// The widths up to which row_norms() sums: it sums squares, which fall off as 1/rho^4, so what is beyond hardly counts.
constexpr double kRowReach = 8;
// The least norm of a row, of the largest: about what the far points add to a point without neighbours, which are not summed. Without it
// such a point would be weighed without bound.
constexpr double kLeastRow = 1e-5;

Vec3 multiplied(const Vec3& a, const Vec3& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

}  // namespace

StretchedWinding::StretchedWinding(const std::vector<Vec3>& points, const Vec3& stretch, double epsilon, const SumPlan& plan,
                                   const std::atomic<bool>* cancel)
    : cancel_(cancel) {
  const double largest = std::max({stretch[0], stretch[1], stretch[2]});
  const Vec3 s = vector::scale(stretch, 1 / largest);
  const double determinant = s[0] * s[1] * s[2];
  cofactors_ = {determinant / s[0], determinant / s[1], determinant / s[2]};
  epsilon_ = epsilon * std::cbrt(determinant);
  std::vector<Vec3> stretched(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) stretched[i] = multiplied(s, points[i]);
  index_ = morton_order(stretched);
  std::vector<Vec3> sorted(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) sorted[k] = stretched[index_[k]];
  points_ = std::make_unique<const std::vector<Vec3>>(std::move(sorted));
  sum_ = std::make_unique<FastSum>(*points_, Widths(epsilon_), plan, cancel);
}

std::vector<double> StretchedWinding::apply(const std::vector<Vec3>& eta) {
  std::vector<Vec3> stretched(eta.size());
  for (std::size_t k = 0; k < eta.size(); ++k) stretched[k] = multiplied(cofactors_, eta[index_[k]]);
  const std::vector<double> w = sum_->winding(stretched);
  std::vector<double> out(w.size());
  for (std::size_t k = 0; k < w.size(); ++k) out[index_[k]] = w[k];
  return out;
}

std::vector<Vec3> StretchedWinding::adjoint(const std::vector<double>& q) {
  std::vector<double> sorted(q.size());
  for (std::size_t k = 0; k < q.size(); ++k) sorted[k] = q[index_[k]];
  const std::vector<Vec3> v = sum_->winding_adjoint(sorted);
  std::vector<Vec3> out(v.size());
  for (std::size_t k = 0; k < v.size(); ++k) out[index_[k]] = multiplied(cofactors_, v[k]);
  return out;
}

std::vector<double> StretchedWinding::row_norms() const {
  const std::vector<Vec3>& points = *points_;
  const NearPairs near = near_pairs(points, kRowReach * epsilon_, cancel_);
  std::vector<double> norms(points.size());
  double largest = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    double sum = 0;
    for (std::size_t i = near.first[k]; i < near.first[k + 1]; ++i) {
      const Vec3 r = vector::subtract(points[near.other[i]], points[k]);
      const Vec3 row = vector::scale(multiplied(cofactors_, r), mollified_kernels(vector::dot(r, r), epsilon_).double_layer);
      sum += vector::dot(row, row);
    }
    norms[index_[k]] = sum;
    largest = std::max(largest, sum);
  }
  for (double& v : norms) v = std::max(v, kLeastRow * largest);
  return norms;
}

}  // namespace g3r
