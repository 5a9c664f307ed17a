// Points as g3r takes and returns them: a view of the caller's array (never copied by the caller), and plain triples.
#pragma once

#include <g3r/export.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace G3R_PUBLIC g3r {

/// A point or vector, in the units of the input.
using Vec3 = std::array<double, 3>;

/// Scalar type of a caller's array.
enum class Scalar { kFloat32, kFloat64 };

/// A read-only view of `count` points; point i's x, y, z are three adjacent scalars at `data + i * stride_bytes`.
/// The array is not owned and must outlive the call it is passed to. Non-finite points are allowed; see Orientation.
struct PointsView {
  const void* data = nullptr;
  std::size_t count = 0;
  Scalar scalar = Scalar::kFloat64;
  std::ptrdiff_t stride_bytes = 0;

  PointsView() = default;
  /// A strided array: `stride_bytes` from one point to the next, 0 for tightly packed.
  PointsView(const void* points, std::size_t n, Scalar type, std::ptrdiff_t stride = 0)
      : data(points), count(n), scalar(type), stride_bytes(stride != 0 ? stride : (type == Scalar::kFloat64 ? 24 : 12)) {}
  /// Tightly packed N x 3 doubles, row-major.
  PointsView(const double* points, std::size_t n) : PointsView(points, n, Scalar::kFloat64) {}
  /// Tightly packed N x 3 floats, row-major.
  PointsView(const float* points, std::size_t n) : PointsView(points, n, Scalar::kFloat32) {}
  /// A vector of points.
  PointsView(const std::vector<Vec3>& points) : PointsView(points.data(), points.size(), Scalar::kFloat64) {}  // NOLINT

  /// Point i in double.
  [[nodiscard]] Vec3 operator[](std::size_t i) const {
    const auto* base = static_cast<const std::byte*>(data) + static_cast<std::ptrdiff_t>(i) * stride_bytes;
    if (scalar == Scalar::kFloat64) {
      const auto* p = reinterpret_cast<const double*>(base);
      return {p[0], p[1], p[2]};
    }
    const auto* p = reinterpret_cast<const float*>(base);
    return {p[0], p[1], p[2]};
  }
};

}  // namespace g3r
