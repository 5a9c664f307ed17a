// L D L^T of small symmetric matrices solves A x = b as Eigen's does, whatever the order of the pivots.
#include "cloud/small_ldlt.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace g3r {
namespace {

constexpr int kCases = 1000;
constexpr double kRounding = 1e-9;  // times the norms: the least pivots are 1e-3 of the largest

template <int N>
void solve_random_systems() {
  using Square = Eigen::Matrix<double, N, N>;
  using Numbers = Eigen::Vector<double, N>;
  shapes::Random random(N);
  for (int k = 0; k < kCases; ++k) {
    Square factor;
    Numbers b;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) factor(i, j) = random.uniform(-1, 1);
      b[i] = random.uniform(-1, 1);
    }
    const Square a = factor * factor.transpose() + 1e-3 * Square::Identity();
    Square lower = a;
    lower.template triangularView<Eigen::StrictlyUpper>().setZero();  // it is not read
    const Numbers x = SmallLdlt<N>(lower).solve(b);
    EXPECT_LE((a * x - b).norm(), kRounding * a.norm() * x.norm());
    EXPECT_LE((x - a.ldlt().solve(b)).norm(), kRounding * x.norm());
  }
}

TEST(SmallLdlt, SolvesRandomSystems) {
  solve_random_systems<2>();
  solve_random_systems<3>();
  solve_random_systems<5>();
  solve_random_systems<7>();
}

TEST(SmallLdlt, UnknownsWithoutEquationAreZero) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  a(1, 1) = 4;
  EXPECT_EQ(SmallLdlt<3>(a).solve({7, 8, 0}), Eigen::Vector3d(0, 2, 0));
}

}  // namespace
}  // namespace g3r
