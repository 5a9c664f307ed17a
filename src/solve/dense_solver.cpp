#include "solve/dense_solver.h"

#include "cpu/parallel.h"
#include "kernels/kernels.h"

#include <g3r/error.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <string>

namespace g3r {
namespace {

// The points whose rows are assembled together, and the columns of a tile of the normal matrix: both bound what a step has in the cache.
// They fix the order of additions, so another number changes the last digits.
constexpr std::size_t kRowPoints = 64;
constexpr Eigen::Index kTile = 192;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The lower triangle of M becomes L with M = L L^T, a panel of kTile columns at a time (right-looking). False: M is singular to rounding.
bool factorise(Eigen::MatrixXd& m, const std::atomic<bool>* cancel) {
  const Eigen::Index size = m.rows();
  for (Eigen::Index begin = 0; begin < size; begin += kTile) {
    const Eigen::Index width = std::min(kTile, size - begin);
    const Eigen::Index end = begin + width;
    Eigen::Ref<Eigen::MatrixXd> corner = m.block(begin, begin, width, width);
    if (const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(corner); factor.info() != Eigen::Success) return false;
    const auto tiles = static_cast<std::size_t>((size - end + kTile - 1) / kTile);
    const auto tile_begin = [&](std::size_t tile) { return end + static_cast<Eigen::Index>(tile) * kTile; };
    parallel::for_each(tiles, [&](std::size_t tile) {  // L21 = M21 L11^-T
      const Eigen::Index row = tile_begin(tile);
      auto below = m.block(row, begin, std::min(kTile, size - row), width);
      corner.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
    });
    parallel::for_each(  // M22 -= L21 L21^T
        tiles,
        [&](std::size_t tile) {
          const Eigen::Index column = tile_begin(tile);
          const Eigen::Index columns = std::min(kTile, size - column);
          m.block(column, column, size - column, columns).noalias() -=
              m.block(column, begin, size - column, width) * m.block(column, begin, columns, width).transpose();
        },
        cancel);
  }
  return true;
}

// Of a symmetric matrix, of which the lower triangle is read, and that has its greatest element there. SelfAdjointEigenSolver::compute()
// takes the same steps, and a quarter of the time that this file takes to compile, for eigenvectors that nobody asks for.
double condition_number_of(const Eigen::MatrixXd& matrix) {
  const Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal(matrix / matrix.cwiseAbs().maxCoeff());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(tridiagonal.diagonal(), tridiagonal.subDiagonal(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff() / solver.eigenvalues().minCoeff();
}

}  // namespace

std::vector<double> assemble_rows(const std::vector<Vec3>& points, double epsilon, const HarmonicValues& u, std::size_t first_point,
                                  std::size_t last_point) {
  const std::size_t n = points.size();
  std::vector<double> rows((last_point - first_point) * u.count * 3 * n);
  parallel::for_each(last_point - first_point, [&](std::size_t row) {
    const Vec3& x = points[first_point + row];
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 r{points[i][0] - x[0], points[i][1] - x[1], points[i][2] - x[2]};
      const KernelValues kernel = mollified_kernels(r[0] * r[0] + r[1] * r[1] + r[2] * r[2], epsilon);
      for (std::size_t k = 0; k < u.count; ++k) {
        const Vec3& gradient = u.gradient[i * u.count + k];
        const double flux = u.value[i * u.count + k] * kernel.double_layer;
        double* out = rows.data() + ((row * u.count + k) * n + i) * 3;
        for (std::size_t a = 0; a < 3; ++a) out[a] = kernel.single_layer * gradient[a] + flux * r[a];
      }
    }
  });
  return rows;
}

DenseResult solve_dense(const std::vector<Vec3>& points, double epsilon, const HarmonicValues& u, bool condition_number,
                        const std::atomic<bool>* cancel) {
  const std::size_t n = points.size();
  if (n > kMostDensePoints) {
    throw InvalidInput("the dense solver takes at most " + std::to_string(kMostDensePoints) + " points, this cloud has " +
                       std::to_string(n) + "; use the iterative solver (cg)");
  }
  const auto size = static_cast<Eigen::Index>(3 * n);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  const Eigen::Index tiles = (size + kTile - 1) / kTile;
  for (std::size_t first = 0; first < n; first += kRowPoints) {
    const std::size_t last = std::min(n, first + kRowPoints);
    const std::vector<double> storage = assemble_rows(points, epsilon, u, first, last);
    const Eigen::Map<const RowMatrix> rows(storage.data(), static_cast<Eigen::Index>((last - first) * u.count), size);
    const Eigen::Map<const Eigen::VectorXd> values(u.value.data() + first * u.count, rows.rows());
    right.noalias() += rows.transpose() * (0.5 * values);
    parallel::for_each(  // M += rows^T rows, lower triangle, a column tile at a time
        static_cast<std::size_t>(tiles),
        [&](std::size_t tile) {
          const Eigen::Index begin = static_cast<Eigen::Index>(tile) * kTile;
          const Eigen::Index width = std::min(kTile, size - begin);
          normal.block(begin, begin, size - begin, width).noalias() +=
              rows.rightCols(size - begin).transpose() * rows.middleCols(begin, width);
        },
        cancel);
  }
  DenseResult result;
  if (condition_number) {
    result.condition_number = condition_number_of(normal);
  }
  if (!factorise(normal, cancel)) return result;
  normal.triangularView<Eigen::Lower>().solveInPlace(right);
  normal.transpose().triangularView<Eigen::Upper>().solveInPlace(right);  // right is eta now
  result.eta.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < 3; ++a) result.eta[i][a] = right[static_cast<Eigen::Index>(3 * i + a)];
  }
  return result;
}

}  // namespace g3r
