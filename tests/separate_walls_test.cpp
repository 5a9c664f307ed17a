// Narrower kernels separate walls that those for the noise take for one, and change nothing where there is no wall to find.
#include "orient/separate_walls.h"

#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace g3r {
namespace {

// Before and after of a cloud with this noise.
struct Separated {
  Separated(const shapes::Surface& s, double noise) {
    const Monitor monitor;
    Stages stages(monitor);
    Options options;
    options.noise = {Length::Unit::kInput, noise};
    options.without = "outliers";
    Attempt found = attempt(prepare(s.points, {}, options, stages), s.points, options, stages);
    const std::vector<Vec3> truth = problems::in_its_order(found.problem, s.normals);
    noise_before = found.problem.noise;
    said_before = found.stats.noise;
    right_before = shapes::share_correct(found.oriented.solution.refinement.normals, truth);
    found = separate_walls(std::move(found), s.points, options, stages);
    noise_after = found.problem.noise;
    said_after = found.stats.noise;
    right_after = shapes::share_correct(found.oriented.solution.refinement.normals, truth);
  }
  double noise_before = 0, noise_after = 0;
  double said_before = 0, said_after = 0;
  double right_before = 0, right_after = 0;
};

// Kernels are as wide as the square of the noise asks for.
TEST(Narrower, TwiceHalvesTheSquareOfTheNoiseTwoRootsAtATime) {
  EXPECT_DOUBLE_EQ(std::pow(next_hidden_noise(0.3) / 0.3, 2), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(next_hidden_noise(next_hidden_noise(next_hidden_noise(next_hidden_noise(0.3)))), 0.15);
}

// Walls of 3.6 sigma, 5.4 sigma apart, under noise of 0.55 spacings.
TEST(SeparateWalls, FindsMoreSidesOfPlatesThatMerge) {
  shapes::Surface s = shapes::plates(6, 0.65, 2, 3, 0.02);
  shapes::scatter(s, 0.55 * 0.02);
  const Separated plates(s, 0.55 * 0.02);
  EXPECT_LT(plates.noise_after, next_hidden_noise(plates.noise_before) * (1 + 1e-12));
  EXPECT_GT(plates.right_after, plates.right_before + 0.05);
  EXPECT_EQ(plates.said_after, plates.said_before);  // the noise of the points, not what kernels hide
}

TEST(SeparateWalls, LeavesSurfacesThatAreOne) {
  shapes::Surface noisy = shapes::torus(6000, 0.6, 0.25, 2);
  shapes::scatter(noisy, 0.02);
  EXPECT_EQ(Separated(noisy, 0.02).noise_after, Separated(noisy, 0.02).noise_before);
  const Separated clean(shapes::sphere(2000), 0);
  EXPECT_EQ(clean.noise_after, 0);
  EXPECT_EQ(clean.right_after, 1);
}

}  // namespace
}  // namespace g3r
