// Areas of oriented points: they add up to the surface, and their field is 1 inside and 0 outside.
#include "field/areas.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "shapes.h"

namespace g3r {
namespace {

double total(const std::vector<double>& areas) { return std::accumulate(areas.begin(), areas.end(), 0.0); }

// Points at random on spheres of radius 1 and 1/2, moved by Gaussian noise: a ball with a cavity.
std::vector<Vec3> hollow_ball(std::size_t n, double sigma) {
  shapes::Random random(5);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 p = random.direction();
    for (double& c : p) c = (i % 5 == 0 ? 0.5 : 1) * c + sigma * random.gaussian();
    points.push_back(p);
  }
  return points;
}

// The level of either side becomes one half, as far as the bounds of the factor go.
TEST(AreaFactor, MakesTheLevelOneHalfWithinItsBounds) {
  for (const double level : {0.39, 0.5, 1.0, 1.49}) {
    EXPECT_DOUBLE_EQ(area_factor(level) * level, 0.5);
    EXPECT_EQ(area_factor(-level), area_factor(level));
  }
  EXPECT_DOUBLE_EQ(area_factor(100), 1.0 / 3);
  EXPECT_EQ(area_factor(0.1), 1.3);
  EXPECT_EQ(area_factor(0), 1.3);
}

// Solved vectors become shorter under noise, each as it comes, and then w is 0.7 in gaps where it should be 0.
TEST(Areas, AddUpUnderNoise) {
  const std::size_t n = 15000;
  const double truth = 4 * M_PI * 1.25, h = std::sqrt(truth / static_cast<double>(n));
  const std::vector<Vec3> places{{0, 0, 0.75}, {0.75, 0, 0}, {-0.5, 0.5, 0.3}, {0, 0, 0}, {0.2, 0.1, -0.1}, {0, 0, 1.25}, {1.5, 0, 0.2}};
  for (const double sigma : {0.0, 0.5, 1.5}) {
    const std::vector<Vec3> noisy = hollow_ball(n, sigma * h);
    const Orientation o = orient(noisy);
    EXPECT_NEAR(total(o.areas), truth, 0.06 * truth) << sigma;
    const std::vector<double> w = Field(noisy, o).value(places);
    for (std::size_t i = 0; i < places.size(); ++i) EXPECT_NEAR(w[i], i < 3 ? 1 : 0, 0.06) << sigma << ' ' << i;
  }
}

// The eighth neighbour on a square grid is nearer than among random points of that density.
TEST(Areas, AddUpOnAGrid) {
  const int k = 30;
  std::vector<Vec3> points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < k; ++i) {
        for (int j = 0; j < k; ++j) {
          Vec3 p;
          p[axis] = side;
          p[(axis + 1) % 3] = (2 * i + 1.0) / k - 1;
          p[(axis + 2) % 3] = (2 * j + 1.0) / k - 1;
          points.push_back(p);
        }
      }
    }
  }
  const Orientation o = orient(points);
  EXPECT_NEAR(total(o.areas), 24, 0.05 * 24);
  EXPECT_NEAR(Field(points, o).value(std::vector<Vec3>{{0, 0, 0}})[0], 1, 0.05);
}

}  // namespace
}  // namespace g3r
