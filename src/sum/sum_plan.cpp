#include "sum/sum_plan.h"

#include <g3r/error.h>

#include <array>

namespace g3r {
namespace {

struct Setting {
  double accuracy;
  int order;
  double opening;
  double cut;
  double reach;
  std::size_t leaf_points;
  bool double_precision;
};

// Cheapest first. The measured error of each row, over all test clouds and all four sums, is below its accuracy.
constexpr std::array<Setting, 8> kSettings{{{2e-2, 4, 0.8, 3, 4, 48, false},
                                            {1e-2, 5, 0.8, 3, 4, 64, false},
                                            {3e-3, 7, 0.73, 6, 4, 64, false},
                                            {1e-3, 7, 0.68, 7, 5, 72, false},
                                            {3e-4, 8, 0.65, 4, 5, 96, false},
                                            {1e-4, 10, 0.65, 5, 5, 128, false},
                                            {1e-5, 13, 0.55, 7, 7, 128, true},
                                            {1e-6, 14, 0.5, 5, 7, 128, true}}};
constexpr double kLoosest = 1e-1;
constexpr double kKernelShare = 0.4;            // of the accuracy: what the kernels of near pairs may err by
constexpr std::size_t kDirectBelow = 2000;      // measured crossover of the direct and the hierarchical sum
constexpr std::size_t kDirectLeafPoints = 256;  // direct sums: leaves only bound the rounding of local coordinates

}  // namespace

SumPlan sum_plan(double accuracy, std::size_t points) {
  if (accuracy != 0 && !(accuracy >= kSettings.back().accuracy && accuracy <= kLoosest)) {
    throw InvalidInput("accuracy must be 0 (direct sums) or between 1e-6 and 1e-1");
  }
  const Setting* setting = &kSettings.front();
  for (const Setting& s : kSettings) {
    setting = &s;
    if (s.accuracy <= accuracy) break;
  }
  SumPlan plan;
  plan.double_precision = setting->double_precision;
  plan.order = setting->order;
  plan.opening = setting->opening;
  plan.cut = setting->cut;
  plan.reach = setting->reach;
  plan.kernel_error = kKernelShare * setting->accuracy;
  plan.leaf_points = setting->leaf_points;
  plan.direct = accuracy == 0 || points < kDirectBelow;
  if (plan.direct) {
    plan.opening = 0;
    plan.reach = kSettings.back().reach;  // the whole kernel
    plan.kernel_error = 0;
    plan.leaf_points = kDirectLeafPoints;
  }
  return plan;
}

}  // namespace g3r
