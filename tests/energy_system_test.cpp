// The energy system: the same for every unit of length, with a weight of the winding number in cubed lengths, and semidefinite.
#include "solve/energy_system.h"

#include "cloud/canonical_cloud.h"
#include "orient/settings.h"
#include "shapes.h"
#include "sum/direct_sum.h"
#include "sum/fast_sum.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

// S of lengths c times as large is S / c, and W is W / c^2. With e c, d / c and l c^3 so is M = S + d I + l W^T W, and b = l/2 W^T 1 is c
// b: the solution is c^2 eta, the same areas.
TEST(EnergySystem, HasNoUnitOfLength) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(300, 0.6, 0.25, 1).points);
  const double c = 0.125;  // a power of two: the order stays
  const double width = 0.05, damping = 3, weight = 1e-3;
  std::vector<Vec3> scaled = cloud.points();
  for (Vec3& p : scaled) {
    for (double& x : p) x *= c;
  }
  FastSum sum(cloud.points(), Widths(width), sum_plan(0, cloud.size()));
  FastSum small_sum(scaled, Widths(c * width), sum_plan(0, cloud.size()));
  EnergySystem system(sum, damping, weight);
  EnergySystem small(small_sum, damping / c, weight * c * c * c);
  shapes::Random random(2);
  std::vector<Vec3> eta(cloud.size());
  for (Vec3& v : eta) v = random.direction();
  const std::vector<Vec3> product = product_of(system, eta), small_product = product_of(small, eta);
  const std::vector<Vec3> right = system.right_side(), small_right = small.right_side();
  double error = 0, size = 0;
  for (std::size_t i = 0; i < eta.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      error += std::pow(c * small_product[i][a] - product[i][a], 2) + std::pow(small_right[i][a] / c - right[i][a], 2);
      size += std::pow(product[i][a], 2) + std::pow(right[i][a], 2);
    }
  }
  constexpr double kRounding = 1e-12;  // direct sums in double
  EXPECT_LE(std::sqrt(error / size), kRounding);
}

// So do the weights that are chosen: in proportion to h they are four times as heavy at 16 times the points, and noise is fitted.
TEST(EnergySystem, IsWeightedAlikeForEverySpacing) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(300, 0.6, 0.25, 1).points);
  for (const double noise : {0.0, 0.5, 1.0}) {
    const double h = 0.1;
    const Settings wide = choose_settings({}, cloud, h, noise * h, 0);
    const Settings narrow = choose_settings({}, cloud, h / 4, noise * h / 4, 0);
    EXPECT_NEAR(wide.winding_weight / narrow.winding_weight, 64, 1e-9) << noise;
    EXPECT_NEAR(wide.polish.winding_weight / narrow.polish.winding_weight, 64, 1e-9) << noise;
  }
}

// Of any points and any widths, also where each point has its own: the symbol of a pair is that of one width, times exp(-e_i^2 k^2 / 4) for
// either point. Without e^2 g beside Phi it is negative along k.
TEST(EnergySystem, StokesIsSymmetricAndPositiveSemidefinite) {
  constexpr std::size_t kPoints = 50;
  shapes::Random random(6);
  std::vector<Vec3> points(kPoints);
  std::vector<double> own(kPoints);
  for (Vec3& p : points) p = {random.uniform(-1, 1), random.uniform(-1, 1), 0.1 * random.uniform(-1, 1)};
  for (double& w : own) w = std::pow(10, random.uniform(-2, 0.5));
  for (const Widths& widths : {Widths(0.01), Widths(0.3), Widths(5.0), Widths(own)}) {
    Eigen::MatrixXd s(3 * kPoints, 3 * kPoints);
    for (std::size_t column = 0; column < 3 * kPoints; ++column) {
      std::vector<Vec3> eta(kPoints, Vec3{0, 0, 0});
      eta[column / 3][column % 3] = 1;
      const std::vector<Vec3> product = direct_sum::stokes_single_layer(points, widths, eta);
      for (std::size_t row = 0; row < 3 * kPoints; ++row) {
        s(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = product[row / 3][row % 3];
      }
    }
    EXPECT_LT((s - s.transpose()).norm(), 1e-14 * s.norm());
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(s, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-13 * values.maxCoeff()) << widths[0];
  }
}

}  // namespace
}  // namespace g3r
