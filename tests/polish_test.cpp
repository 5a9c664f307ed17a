#include "orient/polish.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace g3r {
namespace {

double length(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

struct Ball {
  CanonicalCloud cloud = canonical_cloud(shapes::sphere(800).points);
  Settings settings = choose_settings({}, cloud, cloud.set.spacing(), 0, 0);
  std::vector<Vec3> truth;

  Ball() {
    for (const Vec3& p : cloud.points()) truth.push_back(vector::normalised(p));  // the centre of the frame is that of the ball
  }
};

TEST(LocalWidths, AreInProportionToTheSpacing) {
  Settings settings;
  settings.spacing = 0.5;
  const KernelWidth clean{0.1, 0, 0};
  const Widths same = local_widths(clean, settings, {});
  EXPECT_EQ(same[3], 0.1);
  const Widths local = local_widths(clean, settings, {0.5, 1, 0.25});
  EXPECT_DOUBLE_EQ(local[0], 0.1);
  EXPECT_DOUBLE_EQ(local[1], 0.2);
  EXPECT_DOUBLE_EQ(local[2], 0.05);
}

// The noise is the same everywhere: kernels that hide it hide single points too until these are farther apart than that.
TEST(LocalWidths, HideTheNoiseWhereItIsMoreThanTheSpacing) {
  Settings settings;
  settings.spacing = 1;
  const Widths widths = local_widths({0.5, 2, 0}, settings, {0.5, 1, 4, 8});
  EXPECT_DOUBLE_EQ(widths[0], 2);
  EXPECT_DOUBLE_EQ(widths[1], 2);
  EXPECT_DOUBLE_EQ(widths[2], 2);
  EXPECT_DOUBLE_EQ(widths[3], 4);
  const Widths roots = local_widths({0.1, 2, 0.5}, settings, {1, 4});
  EXPECT_DOUBLE_EQ(roots[0], 2);
  EXPECT_DOUBLE_EQ(roots[1], 4);
}

TEST(GradientToAreas, HaveTheWindingNumberOfASurfaceWhateverTheGradientsSize) {
  const Ball ball;
  FastSum sum(ball.cloud.points(), Widths(ball.settings.epsilon.typical()), ball.settings.sums);
  const std::vector<double> areas{ball.settings.spacing * ball.settings.spacing};
  std::vector<Vec3> eta = ball.truth, other = ball.truth;
  for (Vec3& v : other) {
    for (double& c : v) c *= 1000;
  }
  gradient_to_areas(sum, areas, eta);
  gradient_to_areas(sum, areas, other);
  EXPECT_NEAR(median(sum.winding(eta)), 0.5, 1e-5);  // sums are in single precision
  for (std::size_t i = 0; i < eta.size(); ++i) {
    EXPECT_NEAR(length(other[i]), length(eta[i]), 1e-6 * length(eta[i]));
    EXPECT_NEAR(vector::dot(vector::normalised(eta[i]), ball.truth[i]), 1, 1e-12);  // directions stay
  }
}

// Gradients of the lengths 1, 2, ..., 5, of the median 3, at points that stand for one or four areas.
TEST(GradientToAreas, AreLinearUpToTheMedianAndConstantBeyond) {
  const Ball ball;
  FastSum sum(ball.cloud.points(), Widths(ball.settings.epsilon.typical()), ball.settings.sums);
  std::vector<Vec3> eta = ball.truth;
  std::vector<double> areas, expected;
  for (std::size_t i = 0; i < eta.size(); ++i) {
    const double size = 1 + static_cast<double>(i % 5);
    eta[i] = vector::scale(eta[i], size);
    areas.push_back(i % 2 == 0 ? 1 : 4);
    expected.push_back(areas.back() * std::min(1.0, size / 3));
  }
  gradient_to_areas(sum, areas, eta);
  for (std::size_t i = 0; i < eta.size(); ++i) EXPECT_NEAR(length(eta[i]) / length(eta[2]), expected[i] / expected[2], 1e-12) << i;
}

TEST(Polish, BringsDirectionsNearerToTheTruth) {
  const Ball ball;
  const std::vector<Vec3> disturbed = shapes::disturbed(ball.truth, 0.2);
  const Refinement start{disturbed, std::vector<double>(disturbed.size(), 1.0)};
  const Monitor monitor;
  Stages stages(monitor);
  const std::vector<double>& spacing = ball.cloud.set.smoothed_spacing();
  const PolishCloud cloud{ball.cloud.points(), spacing, point_areas(ball.settings, spacing), {}};
  const Polished polished = polish(cloud, ball.settings, start, stages);
  EXPECT_EQ(shapes::share_correct(polished.refinement.normals, ball.truth), 1);
  EXPECT_LT(shapes::angle_error(polished.refinement.normals, ball.truth), 0.1 * shapes::angle_error(disturbed, ball.truth));
}

}  // namespace
}  // namespace g3r
