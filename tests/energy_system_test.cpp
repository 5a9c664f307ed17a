// The energy system: the same for every unit of length, with a weight of the winding number in cubed lengths.
#include "solve/energy_system.h"

#include "cloud/canonical_cloud.h"
#include "orient/settings.h"
#include "shapes.h"
#include "sum/fast_sum.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace g3r
