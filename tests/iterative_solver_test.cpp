// Steepest descent and conjugate gradients where the number of steps to the solution is known.
#include "solve/iterative_solver.h"

#include "base/vector.h"

#include <g3r/error.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace g3r {
namespace {

// M = diag(1, 4, 9, 1, 4, 9, ...) of points, b of all ones: more points than a block of the reductions.
class ThreeEigenvalues : public LinearSystem {
 public:
  static constexpr std::size_t kPoints = 5000;
  void apply(const std::vector<Vec3>& x, std::vector<Vec3>& product) override {
    product = x;
    for (std::size_t i = 0; i < x.size(); ++i) product[i] = vector::scale(x[i], std::pow(static_cast<double>(1 + i % 3), 2));
  }
  std::vector<Vec3> right_side() override { return std::vector<Vec3>(kPoints, Vec3{1, 1, 1}); }
  double residual(const std::vector<Vec3>& x) {
    const std::vector<Vec3> product = product_of(*this, x);
    double sum = 0;
    for (const Vec3& p : product) sum += std::pow(vector::length(vector::subtract({1, 1, 1}, p)), 2);
    return std::sqrt(sum / (3 * kPoints));
  }
};

TEST(IterativeSolver, EndsAfterAsManyStepsAsThereAreEigenvaluesAndSaysHowFarItIs) {
  ThreeEigenvalues system;
  const std::vector<Vec3> near(ThreeEigenvalues::kPoints, Vec3{0.5, 0.3, 0.1});
  for (const std::vector<Vec3>& start : {std::vector<Vec3>{}, near}) {
    for (const StepKind kind : {StepKind::kConjugateGradient, StepKind::kSteepestDescent}) {
      for (const int steps : {1, 2, 3}) {
        const IterativeResult found = solve_iteratively(system, {{steps, kind}}, 0, start);
        ASSERT_EQ(found.residuals.size(), static_cast<std::size_t>(steps));
        EXPECT_NEAR(found.residuals.back(), system.residual(found.eta), 1e-13);  // relative to |b|, whatever the start
        EXPECT_EQ(found.residuals.back() < 1e-12, steps == 3 && kind == StepKind::kConjugateGradient);
      }
    }
  }
  const IterativeResult done = solve_iteratively(system, {{9, StepKind::kConjugateGradient}}, 1e-6);
  EXPECT_TRUE(done.converged);
  EXPECT_EQ(done.residuals.size(), 3U);
  EXPECT_FALSE(solve_iteratively(system, {{2, StepKind::kConjugateGradient}}, 1e-6).converged);
}

TEST(Schedule, IsParsedOrRefused) {
  const std::vector<Steps> steps = parse_schedule("20 sd 60 cg");
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].count, 20);
  EXPECT_EQ(steps[1].kind, StepKind::kConjugateGradient);
  for (const char* bad : {"", "sd", "20", "20 xx", "-1 cg", "20 sd 5", "1e3 cg", "20 sd,60 cg"}) {
    EXPECT_THROW(static_cast<void>(parse_schedule(bad)), InvalidInput) << bad;
  }
}

}  // namespace
}  // namespace g3r
