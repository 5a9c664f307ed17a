// A smooth patch of surface, fitted to points and their normals.
#pragma once

#include "cloud/constants.h"

#include <g3r/points.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {

/// A smooth patch: height a + b u + c v + d u^2 + e u v + g v^2 over a tangent plane, outside above.
struct QuadraticPatch {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< rows: u, v, normal
  std::array<double, kQuadraticTerms> c{};

  /// Distance to the patch to first order, positive outside, and its gradient (about a unit vector; may be null).
  double distance(const Eigen::Vector3d& x, Eigen::Vector3d* gradient = nullptr) const {
    const Eigen::Vector3d q = frame * (x - origin);
    const double u = q[0], v = q[1];
    const double gu = c[1] + 2 * c[3] * u + c[4] * v, gv = c[2] + c[4] * u + 2 * c[5] * v;
    const double length = std::sqrt(1 + gu * gu + gv * gv);
    if (gradient != nullptr) *gradient = frame.transpose() * Eigen::Vector3d(-gu, -gv, 1) / length;
    return (q[2] - (c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v)) / length;
  }
};

/// A point that takes part in a fit.
struct FitPoint {
  Eigen::Vector3d p, n;  ///< position, unit normal
  double weight = 0;
  int patch = -1;  ///< number of the patch it belongs to, < 0: none
};

/// The patch that minimises sum weight [ (height misfit)^2 + normal_weight h^2 |slope misfit|^2 ] over the points of patch `which`,
/// of which there is at least one with a weight above 0. `h` > 0: length unit of the fit. The normals also give the tangent plane.
/// Throws nothing. O(points).
[[nodiscard]] QuadraticPatch fit_quadratic_patch(const std::vector<FitPoint>& points, int which, double h, double normal_weight);

/// Root mean square distance of these points from the patch, sqrt(sum weight d^2 / sum weight), corrected for kQuadraticTerms: over
/// sqrt(1 - kQuadraticTerms / n), n = (sum weight)^2 / sum weight^2 the effective number of points; infinite where n is no more. O(points).
[[nodiscard]] double residual(const QuadraticPatch& patch, const std::vector<FitPoint>& points);

/// Root mean square distance, corrected for kQuadraticTerms, of points[index[0]], ..., points[index[count - 1]] from the quadratic height
/// field fitted to them over the plane with this normal, count > kQuadraticTerms. `h` > 0: length unit of the fit. O(count).
[[nodiscard]] double quadratic_residual(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal,
                                        double h);

/// The same three numbers.
[[nodiscard]] inline Eigen::Vector3d to_eigen(const Vec3& p) { return {p[0], p[1], p[2]}; }

/// Rows: two directions across `n` (unit length), and n; right-handed.
[[nodiscard]] Eigen::Matrix3d tangent_frame(const Eigen::Vector3d& n);

}  // namespace g3r
