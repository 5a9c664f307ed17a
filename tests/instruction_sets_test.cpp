// Every instruction set that this machine and the build have gives the same sums.
#include "cloud/canonical_cloud.h"
#include "cpu/near_field.h"
#include "shapes.h"
#include "sum/fast_sum.h"
#include "sum_cases.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace g3r {
namespace {

class InstructionSets : public testing::TestWithParam<double> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(InstructionSets, Agree) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  if (targets.size() < 2) GTEST_SKIP() << "one instruction set";
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(3000, 0.6, 0.25, 3).points);
  const sum_cases::Inputs in(cloud.points(), Widths(0.01));
  const SumPlan plan = sum_plan(GetParam(), 1000000);
  const sum_cases::Sums best = sum_cases::fast_sums(in, plan);
  // Rounding of double or float sums of 3000 terms that nearly cancel; from 1e-3 on the estimates of 1 / sqrt, which differ.
  const double most = GetParam() < 1e-4 ? 1e-11 : std::max(1e-4, 0.1 * GetParam());
  std::set<std::string> tried;
  for (const std::int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    tried.insert(cpu::instruction_set());
    EXPECT_LE(sum_cases::worst_error(sum_cases::fast_sums(in, plan), best), most) << cpu::instruction_set();
    hwy::SetSupportedTargetsForTest(0);
  }
  EXPECT_EQ(tried.size(), targets.size());
}

INSTANTIATE_TEST_SUITE_P(Accuracies, InstructionSets, testing::Values(1e-2, 1e-3, 3e-4, 1e-5));

}  // namespace
}  // namespace g3r
