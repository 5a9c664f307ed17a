#include "cloud/quadratic_patch.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace g3r {
namespace {

using Eigen::Vector3d;

// On the curvatures, relative to the weight of the data: keeps them bounded where points are few.
constexpr double kCurvatureRidge = 1e-3;

// Symmetric positive definite, the rows of the lower half one after the other.
using Lower = std::array<double, kQuadraticTerms*(kQuadraticTerms + 1) / 2>;

// Replaces b by the solution x of A x = b, by A = L D L^T.
void solve(Lower a, std::array<double, kQuadraticTerms>& b) {
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return a[i * (i + 1) / 2 + j]; };
  for (std::size_t j = 0; j < kQuadraticTerms; ++j) {
    for (std::size_t i = j + 1; i < kQuadraticTerms; ++i) {
      const double factor = at(i, j) / at(j, j);
      for (std::size_t k = j + 1; k <= i; ++k) at(i, k) -= factor * at(k, j);
      b[i] -= factor * b[j];
    }
    for (std::size_t i = j + 1; i < kQuadraticTerms; ++i) at(i, j) /= at(j, j);
  }
  for (std::size_t j = kQuadraticTerms; j-- > 0;) {
    b[j] /= at(j, j);
    for (std::size_t i = j + 1; i < kQuadraticTerms; ++i) b[j] -= at(i, j) * b[i];
  }
}

}  // namespace

Eigen::Matrix3d tangent_frame(const Vector3d& n) {
  Eigen::Matrix3d f;
  const Vector3d u = n.unitOrthogonal();
  f.row(0) = u;
  f.row(1) = n.cross(u);
  f.row(2) = n;
  return f;
}

QuadraticPatch fit_quadratic_patch(const std::vector<FitPoint>& points, int which, double h, double normal_weight) {
  Vector3d mean_p = Vector3d::Zero(), mean_n = Vector3d::Zero();
  double total = 0;
  for (const FitPoint& m : points) {
    if (m.patch != which) continue;
    mean_p += m.weight * m.p;
    mean_n += m.weight * m.n;
    total += m.weight;
  }
  QuadraticPatch s;
  s.origin = mean_p / total;
  s.frame = tangent_frame(mean_n.normalized());
  // The normal equations from the moments sum w u^a v^b, which all their entries are sums of; pairs of u and v side by side.
  using Pair = Eigen::Array2d;
  double m00 = 0, m11 = 0, m22 = 0, right0 = 0, right4 = 0;
  Pair first = Pair::Zero(), second = first, cube = first, mixed = first, fourth = first, uneven = first, slope = first, curved = first;
  for (const FitPoint& m : points) {
    if (m.patch != which) continue;
    const Vector3d q = s.frame * (m.p - s.origin) / h;
    const Vector3d n = s.frame * m.n;
    const double w = m.weight, up = 1 / std::max(n[2], kSameSide), z = q[2];
    const Pair uv(q[0], q[1]), vu(q[1], q[0]), along = -Pair(n[0], n[1]) * up * normal_weight;  // slopes
    const Pair wuv = w * uv, wsquare = wuv * uv, wcube = wsquare * uv, wmixed = wsquare * vu;
    const double product = wuv[0] * q[1];
    m00 += w;
    first += wuv;       // m10, m01
    second += wsquare;  // m20, m02
    m11 += product;
    cube += wcube;                                      // m30, m03
    mixed += wmixed;                                    // m21, m12
    fourth += wcube * uv;                               // m40, m04
    uneven += Pair(wcube[0] * q[1], wmixed[1] * q[1]);  // m31, m13
    m22 += wmixed[0] * q[1];
    right0 += w * z;
    slope += wuv * z + w * along;
    curved += wsquare * z + 2 * wuv * along;
    right4 += product * z + wuv[1] * along[0] + wuv[0] * along[1];
  }
  const double m10 = first[0], m01 = first[1], m20 = second[0], m02 = second[1], m30 = cube[0], m03 = cube[1], m21 = mixed[0],
               m12 = mixed[1], m40 = fourth[0], m04 = fourth[1], m31 = uneven[0], m13 = uneven[1];
  std::array<double, kQuadraticTerms> right{right0, slope[0], slope[1], curved[0], right4, curved[1]};
  // Heights have the row (1, u, v, u^2, uv, v^2), slopes along u (0, 1, 0, 2u, v, 0) and along v (0, 0, 1, 0, u, 2v).
  const double k = normal_weight;
  const Lower lower{m00,
                    m10,
                    m20 + (k + kRidge) * m00,
                    m01,
                    m11,
                    m02 + (k + kRidge) * m00,
                    m20,
                    m30 + 2 * k * m10,
                    m21,
                    m40 + 4 * k * m20 + kCurvatureRidge * m00,
                    m11,
                    m21 + k * m01,
                    m12 + k * m10,
                    m31 + 2 * k * m11,
                    m22 + k * (m20 + m02) + kCurvatureRidge * m00,
                    m02,
                    m12,
                    m03 + 2 * k * m01,
                    m22,
                    m13 + 2 * k * m11,
                    m04 + 4 * k * m02 + kCurvatureRidge * m00};
  solve(lower, right);
  const std::array<double, kQuadraticTerms> unit{h, 1, 1, 1 / h, 1 / h, 1 / h};
  for (std::size_t i = 0; i < kQuadraticTerms; ++i) s.c[i] = right[i] * unit[i];
  return s;
}

double residual(const QuadraticPatch& patch, const std::vector<FitPoint>& points) {
  double total = 0, squares = 0, misfit = 0;
  for (const FitPoint& m : points) {
    const double distance = patch.distance(m.p);
    total += m.weight;
    squares += m.weight * m.weight;
    misfit += m.weight * distance * distance;
  }
  const double effective = total * total / squares;
  if (!(effective > kQuadraticTerms)) return HUGE_VAL;
  return std::sqrt(misfit / total / (1 - kQuadraticTerms / effective));
}

double quadratic_residual(const std::vector<Vec3>& points, const std::uint32_t* index, std::size_t count, const Vec3& normal, double h) {
  std::vector<FitPoint> members;
  for (std::size_t k = 0; k < count; ++k) members.push_back({to_eigen(points[index[k]]), to_eigen(normal), 1, 0});
  return residual(fit_quadratic_patch(members, 0, h, 0), members);
}

}  // namespace g3r
