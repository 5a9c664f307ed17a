#include "orient/memory_plan.h"

#include "sum/sum_plan.h"

#include <g3r/error.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace g3r {
namespace {

TEST(PlannedMemory, HasASiteOfTheCertificateForEveryPointOnlyWithoutNoise) {
  Settings s;
  s.spacing = 0.01;
  const std::size_t clean = planned_memory(s, 100'000, 100'000);
  s.noise = 0.01;
  EXPECT_LT(static_cast<double>(planned_memory(s, 100'000, 100'000)), 0.8 * static_cast<double>(clean));
}

TEST(PlannedMemory, KnowsTheMatricesOfTheSums) {
  Settings s;
  s.spacing = 0.01;
  s.first_sums = sum_plan(1e-2, 10'000);
  const std::size_t usual = planned_memory(s, 10'000, 10'000);
  s.first_sums = sum_plan(1e-5, 10'000);
  EXPECT_GT(planned_memory(s, 10'000, 10'000), usual + 40'000'000);
  s.first_sums = sum_plan(0, 10'000);
  EXPECT_LT(planned_memory(s, 10'000, 10'000), usual);
}

TEST(PlannedMemory, GrowsWithEveryPointAndIsHeldToTheLimit) {
  Settings s;
  s.spacing = 0.01;
  EXPECT_LT(planned_memory(s, 1000, 1000), planned_memory(s, 2000, 1000));
  EXPECT_LT(planned_memory(s, 2000, 1000), planned_memory(s, 2000, 2000));
  s.dense = true;
  EXPECT_GE(planned_memory(s, 1000, 1000), 9 * 1000 * 1000 * sizeof(double));
  EXPECT_LT(planned_memory(s, 1000, 1000), 2 * 9 * 1000 * 1000 * sizeof(double));
  s.condition_number = true;
  EXPECT_GE(planned_memory(s, 1000, 1000), 2 * 9 * 1000 * 1000 * sizeof(double));
  EXPECT_NO_THROW(require_memory(std::size_t{1} << 50, 0, false));  // 0: no limit
  EXPECT_NO_THROW(require_memory(1000, 1000, true));
  for (const bool makes_mesh : {false, true}) {
    try {
      require_memory(1001, 1000, makes_mesh);
      ADD_FAILURE();
    } catch (const Unavailable& error) {
      EXPECT_EQ(std::string(error.what()).find("depth") != std::string::npos, makes_mesh);  // only a mesh has one
    }
  }
}

}  // namespace
}  // namespace g3r
