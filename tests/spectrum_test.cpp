// The spectra behind the paper's Figure 3.
#include "cloud/canonical_cloud.h"
#include "shapes.h"
#include "solve/dense_solver.h"
#include "solve/green_system.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace g3r {
namespace {

// Smallest over largest singular value of the stacked rows A[u_k].
double smallest_singular_ratio(std::size_t n, const std::string& harmonics) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(n, 0.6, 0.25, 3).points);
  const HarmonicValues u = evaluate_harmonics(parse_harmonics(harmonics), cloud.points());
  const std::vector<double> rows = assemble_rows(cloud.points(), 1.0 / static_cast<double>(n), u, 0, cloud.size());
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const RowMatrix> a(rows.data(), static_cast<Eigen::Index>(rows.size() / (3 * cloud.size())),
                                      static_cast<Eigen::Index>(3 * cloud.size()));
  if (a.rows() < a.cols()) return 0;  // fewer equations than unknowns
  // From the eigenvalues of A^T A, whose rounding is 1e-8 of the largest singular value.
  const Eigen::MatrixXd gram = a.transpose() * a;
  const Eigen::VectorXd squares = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues();
  return std::sqrt(std::max(squares.minCoeff(), 0.0) / squares.maxCoeff());
}

TEST(Spectrum, OneHarmonicIsRankDeficientThreeAreNot) {
  for (const std::size_t n : {100UL, 200UL}) {
    EXPECT_EQ(smallest_singular_ratio(n, "1"), 0);
    EXPECT_GT(smallest_singular_ratio(n, "x,y,z"), 1e-6);
    EXPECT_GT(smallest_singular_ratio(n, "1,x,y,z"), 1e-6);
    EXPECT_GT(smallest_singular_ratio(n, "degree:0-2"), smallest_singular_ratio(n, "x,y,z"));
  }
}

}  // namespace
}  // namespace g3r
