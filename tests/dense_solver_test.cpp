// The dense path: equal to the iterative one at convergence.
#include "solve/dense_solver.h"

#include "cloud/canonical_cloud.h"
#include "shapes.h"
#include "solve/green_system.h"
#include "solve/iterative_solver.h"

#include <g3r/error.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r {
namespace {

TEST(DenseSolver, AgreesWithConjugateGradientsAtConvergence) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(250, 0.6, 0.25, 3).points);
  const double epsilon = 0.03;
  const std::vector<Harmonic> harmonics = harmonics_of_degrees(0, 2);
  const DenseResult dense = solve_dense(cloud.points(), epsilon, evaluate_harmonics(harmonics, cloud.points()), true);
  EXPECT_GT(dense.condition_number, 1);
  SumPlan plan = sum_plan(0, cloud.size());
  plan.double_precision = true;
  FastSum sum(cloud.points(), Widths(epsilon), plan);
  GreenSystem system(sum, cloud.points(), harmonics);
  const IterativeResult iterative = solve_iteratively(system, {{4000, StepKind::kConjugateGradient}}, 1e-11);
  EXPECT_TRUE(iterative.converged);
  double difference = 0;
  double size = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      difference += std::pow(dense.eta[i][a] - iterative.eta[i][a], 2);
      size += dense.eta[i][a] * dense.eta[i][a];
    }
  }
  EXPECT_LT(std::sqrt(difference / size), 1e-4);
}

TEST(DenseSolver, KnowsSingularAndRefusesHugeSystems) {
  const CanonicalCloud cloud = canonical_cloud(shapes::sphere(60).points);
  EXPECT_TRUE(solve_dense(cloud.points(), 1e-3, evaluate_harmonics(parse_harmonics("1"), cloud.points()), false).eta.empty());
  EXPECT_THROW(static_cast<void>(solve_dense(std::vector<Vec3>(kMostDensePoints + 1), 1e-3, HarmonicValues{}, false)), InvalidInput);
}

}  // namespace
}  // namespace g3r
