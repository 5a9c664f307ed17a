// Eigen matrices in and out; header-only, needs Eigen 3.4 and is included only by those who have it.
//
//   Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> P = ...;
//   g3r::Orientation o = g3r::orient(g3r::points_view(P));
//   auto N = g3r::as_matrix(o.normals);   // N x 3, a map into o
#pragma once

#include <g3r/mesh.h>
#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

namespace g3r {

/// A view of a matrix whose points lie in memory one after another: N x 3 row-major, or 3 x N column-major, float or double.
/// The matrix must outlive the view. O(1). For other layouts, which do not compile, see points_from().
template <class Matrix>
[[nodiscard]] PointsView points_view(const Eigen::PlainObjectBase<Matrix>& matrix) {
  using T = typename Matrix::Scalar;
  constexpr bool kRows = Matrix::ColsAtCompileTime == 3 && bool(Matrix::IsRowMajor);
  constexpr bool kColumns = Matrix::RowsAtCompileTime == 3 && !bool(Matrix::IsRowMajor);
  static_assert(kRows || kColumns, "points_view() needs N x 3 row-major or 3 x N column-major; use points_from()");
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>, "points are float or double");
  return PointsView(matrix.data(), static_cast<std::size_t>(kRows ? matrix.rows() : matrix.cols()));
}
template <class Matrix>
PointsView points_view(const Eigen::PlainObjectBase<Matrix>&&) = delete;  // the view would outlive the matrix

/// A copy of the rows of any N x 3 matrix expression, for example an Eigen::MatrixXd as libigl has it. O(N). Another number of columns is
/// an eigen_assert().
template <class Derived>
[[nodiscard]] std::vector<Vec3> points_from(const Eigen::MatrixBase<Derived>& matrix) {
  eigen_assert(matrix.cols() == 3);
  std::vector<Vec3> points(static_cast<std::size_t>(matrix.rows()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    points[static_cast<std::size_t>(i)] = {static_cast<double>(matrix(i, 0)), static_cast<double>(matrix(i, 1)),
                                           static_cast<double>(matrix(i, 2))};
  }
  return points;
}

/// Triples as an N x 3 matrix without a copy: normals, vertices, triangles. The vector must outlive the map. O(1).
template <class T>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 3, Eigen::RowMajor>> as_matrix(const std::vector<std::array<T, 3>>& rows) {
  return {rows.empty() ? nullptr : rows[0].data(), static_cast<Eigen::Index>(rows.size()), 3};
}

}  // namespace g3r
