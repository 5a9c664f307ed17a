// Every instruction set that this machine and the build have gives the same sums.
#include "cloud/canonical_cloud.h"
#include "cpu/near_field.h"
#include "shapes.h"
#include "sum/fast_sum.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace g3r {
namespace {

struct Sums {
  std::vector<Vec3> stokes;
  std::vector<double> winding;
  std::vector<Vec3> gradient;
};

Sums sums_of(const CanonicalCloud& cloud, double accuracy) {
  FastSum sum(cloud.points(), Widths(0.01), sum_plan(accuracy, 1000000));
  std::vector<Vec3> eta(cloud.size());
  shapes::Random random(3);
  for (Vec3& v : eta) v = random.direction();
  Sums sums;
  sum.stokes_winding(eta, sums.stokes, sums.winding);
  sums.gradient = sum.winding_gradient(eta);
  return sums;
}

double relative_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double difference = 0;
  double size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      difference += (a[i][k] - b[i][k]) * (a[i][k] - b[i][k]);
      size += b[i][k] * b[i][k];
    }
  }
  return std::sqrt(difference / size);
}

class InstructionSets : public testing::TestWithParam<double> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(InstructionSets, Agree) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(3000, 0.6, 0.25, 3).points);
  const Sums best = sums_of(cloud, GetParam());
  // Rounding of double or float sums of 3000 terms that nearly cancel; from 1e-3 on the estimates of 1 / sqrt, which differ.
  const double most = GetParam() < 1e-4 ? 1e-11 : std::max(1e-4, 0.1 * GetParam());
  std::set<std::string> tried;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    tried.insert(cpu::instruction_set());
    const Sums sums = sums_of(cloud, GetParam());
    EXPECT_LE(relative_difference(sums.stokes, best.stokes), most) << cpu::instruction_set();
    EXPECT_LE(relative_difference(sums.gradient, best.gradient), most) << cpu::instruction_set();
    hwy::SetSupportedTargetsForTest(0);
  }
  EXPECT_EQ(tried.size(), hwy::SupportedAndGeneratedTargets().size());
}

INSTANTIATE_TEST_SUITE_P(Accuracies, InstructionSets, testing::Values(1e-2, 1e-3, 3e-4, 1e-5));

}  // namespace
}  // namespace g3r
