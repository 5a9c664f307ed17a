#include "cloud/quadratic_patch.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace g3r {
namespace {

using Eigen::Vector3d;

// What is added to the weight of the curvatures, relative to that of the data: it keeps them bounded where points are few; more flattens.
constexpr double kCurvatureRidge = 1e-3;

// The numbers of a patch, in the order of QuadraticPatch::c.
using Numbers = std::array<double, kQuadraticTerms>;
// A symmetric positive definite matrix over them, the rows of the lower half one after the other.
using Lower = std::array<double, kQuadraticTerms*(kQuadraticTerms + 1) / 2>;

// Replaces b by the solution x of A x = b, by A = L D L^T.
void solve(Lower a, Numbers& b) {
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

// The normal equations of a fit. A point at (u, v) with the height z and the slopes s and t asks of the six numbers c that
//   (1, u, v, u^2, u v, v^2) . c = z,   (0, 1, 0, 2 u, v, 0) . c = s,   (0, 0, 1, 0, u, 2 v) . c = t,
// so that every entry of the matrix is a sum of moments m_ab = sum w u^a v^b. Of two moments that differ by the exchange of u and v both
// are summed side by side.
class NormalEquations {
 public:
  // `slope_weight`: of a squared misfit of slopes, beside 1 for that of heights.
  explicit NormalEquations(double slope_weight) : slope_weight_(slope_weight) {}

  // `q`: u, v and z, `n`: the unit normal, both in the frame of the patch.
  void add(double weight, const Vector3d& q, const Vector3d& n) {
    const double up = 1 / std::max(n[2], kSameSide), z = q[2];
    const Pair uv(q[0], q[1]), vu(q[1], q[0]), slopes = -Pair(n[0], n[1]) * up * slope_weight_;
    const Pair wuv = weight * uv, wsquare = wuv * uv, wcube = wsquare * uv, wmixed = wsquare * vu;
    const double product = wuv[0] * q[1];
    m00_ += weight;
    m10_m01_ += wuv;
    m20_m02_ += wsquare;
    m11_ += product;
    m30_m03_ += wcube;
    m21_m12_ += wmixed;
    m40_m04_ += wcube * uv;
    m31_m13_ += Pair(wcube[0] * q[1], wmixed[1] * q[1]);
    m22_ += wmixed[0] * q[1];
    right_1_ += weight * z;
    right_u_v_ += wuv * z + weight * slopes;
    right_u2_v2_ += wsquare * z + 2 * wuv * slopes;
    right_uv_ += product * z + wuv[1] * slopes[0] + wuv[0] * slopes[1];
  }

  // The numbers of the patch in units of the fit.
  [[nodiscard]] Numbers solution() const {
    Numbers c{right_1_, right_u_v_[0], right_u_v_[1], right_u2_v2_[0], right_uv_, right_u2_v2_[1]};
    solve(matrix(), c);
    return c;
  }

 private:
  using Pair = Eigen::Array2d;

  [[nodiscard]] Lower matrix() const {
    const double m10 = m10_m01_[0], m01 = m10_m01_[1], m20 = m20_m02_[0], m02 = m20_m02_[1], m30 = m30_m03_[0], m03 = m30_m03_[1],
                 m21 = m21_m12_[0], m12 = m21_m12_[1], m40 = m40_m04_[0], m04 = m40_m04_[1], m31 = m31_m13_[0], m13 = m31_m13_[1];
    const double k = slope_weight_;
    return {m00_,
            m10,
            m20 + (k + kRidge) * m00_,
            m01,
            m11_,
            m02 + (k + kRidge) * m00_,
            m20,
            m30 + 2 * k * m10,
            m21,
            m40 + 4 * k * m20 + kCurvatureRidge * m00_,
            m11_,
            m21 + k * m01,
            m12 + k * m10,
            m31 + 2 * k * m11_,
            m22_ + k * (m20 + m02) + kCurvatureRidge * m00_,
            m02,
            m12,
            m03 + 2 * k * m01,
            m22_,
            m13 + 2 * k * m11_,
            m04 + 4 * k * m02 + kCurvatureRidge * m00_};
  }

  double slope_weight_;
  double m00_ = 0, m11_ = 0, m22_ = 0;
  Pair m10_m01_ = Pair::Zero(), m20_m02_ = Pair::Zero(), m30_m03_ = Pair::Zero(), m21_m12_ = Pair::Zero(), m40_m04_ = Pair::Zero(),
       m31_m13_ = Pair::Zero();
  // The right side: sums of w (row . misfit), by the terms 1; u and v; u^2 and v^2; u v.
  double right_1_ = 0, right_uv_ = 0;
  Pair right_u_v_ = Pair::Zero(), right_u2_v2_ = Pair::Zero();
};

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
  NormalEquations equations(normal_weight);
  for (const FitPoint& m : points) {
    if (m.patch == which) equations.add(m.weight, s.frame * (m.p - s.origin) / h, s.frame * m.n);
  }
  const Numbers solution = equations.solution();
  const Numbers unit{h, 1, 1, 1 / h, 1 / h, 1 / h};
  for (std::size_t i = 0; i < kQuadraticTerms; ++i) s.c[i] = solution[i] * unit[i];
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
