// Quadric error metrics: how far a place is from the planes that a vertex stands for.
//
// Garland, Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
#pragma once

#include "base/vector.h"

#include <algorithm>
#include <array>

namespace g3r::mesh {

/// sum_i w_i (n_i . x + d_i)^2 over planes with weights: x' A x + 2 b' x + c. Places far from 0 lose digits.
class Quadric {
 public:
  double weight = 0;  ///< sum_i w_i

  void add(const Quadric& other) {
    for (std::size_t k = 0; k < a_.size(); ++k) a_[k] += other.a_[k];
    b_ = vector::add(b_, other.b_);
    c_ += other.c_;
    weight += other.weight;
  }
  /// `n`: unit.
  void add_plane(const Vec3& n, double d, double w) {
    std::size_t k = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
      for (std::size_t j = i; j < n.size(); ++j) a_[k++] += w * n[i] * n[j];
    }
    b_ = vector::add(b_, vector::scale(n, w * d));
    c_ += w * d * d;
    weight += w;
  }
  [[nodiscard]] double squared_distances(const Vec3& p) const {
    double square = 0, mixed = 0;
    std::size_t k = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      square += a_[k++] * p[i] * p[i];
      for (std::size_t j = i + 1; j < p.size(); ++j) mixed += a_[k++] * p[i] * p[j];
    }
    return std::max(0.0, square + 2 * mixed + 2 * vector::dot(b_, p) + c_);
  }

 private:
  static constexpr std::size_t kAxes = std::tuple_size_v<Vec3>;
  std::array<double, kAxes*(kAxes + 1) / 2> a_{};  // the upper triangle, row by row
  Vec3 b_{0, 0, 0};
  double c_ = 0;
};

}  // namespace g3r::mesh
