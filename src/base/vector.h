// Arithmetic on Vec3, in a fixed order of operations so that results are the same bytes on every machine.
#pragma once

#include <g3r/points.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace g3r::vector {

inline Vec3 add(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 subtract(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 scale(const Vec3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline bool is_finite(const Vec3& a) { return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]); }

/// a / |a| without overflow or underflow for any finite a; (0, 0, 0) for the zero vector.
inline Vec3 normalised(const Vec3& a) {
  const double largest = std::max({std::fabs(a[0]), std::fabs(a[1]), std::fabs(a[2])});
  if (largest == 0) return {0, 0, 0};
  const Vec3 b{a[0] / largest, a[1] / largest, a[2] / largest};
  return scale(b, 1 / std::sqrt(dot(b, b)));
}

/// The mean of one point or more.
inline Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum{};
  for (const Vec3& p : points) sum = add(sum, p);
  return scale(sum, 1 / static_cast<double>(points.size()));
}

/// An axis-parallel box, empty until it is extended.
struct Box {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  Vec3 high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  void extend(const Vec3& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void extend(const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  /// Halved before adding: the sum of two large coordinates may overflow.
  [[nodiscard]] Vec3 centre() const { return add(scale(low, 0.5), scale(high, 0.5)); }
  [[nodiscard]] double longest_side() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
};

}  // namespace g3r::vector
