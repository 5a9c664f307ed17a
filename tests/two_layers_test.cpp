// Two layers through few points: they have their gap, and one layer is not two.
#include "cloud/two_layers.h"

#include "cloud/neighbours.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace g3r {
namespace {

// Of the 24 points nearest to one on a curved layer that has another beside it.
TwoLayers two_layers(double gap, double sigma) {
  shapes::Random random(7);
  std::vector<Vec3> points;
  for (const double offset : {0.0, gap}) {
    for (int i = 0; i < 100; ++i) {
      const double x = random.uniform(-5, 5), y = random.uniform(-5, 5);
      points.push_back({x, y, offset + 0.3 * x + 0.05 * (x * x - y * y) + sigma * random.gaussian()});
    }
  }
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  Neighbours(points).nearest({0, 0, 0}, 24, index, squared);
  return fit_two_layers(points, index.data(), index.size(), {0.1, 0, std::sqrt(0.99)});
}

TEST(TwoLayers, HaveTheirGap) {
  for (const double gap : {0.3, 0.6, 1.2}) {
    const TwoLayers layers = two_layers(gap, 0);
    EXPECT_NEAR(layers.gap / gap, 1, 0.15) << gap;  // across the slope
    EXPECT_LT(layers.deviation, 0.05 * gap) << gap;
  }
}

TEST(TwoLayers, NoiseAboutOneLayerIsNotTwo) {
  for (const double sigma : {0.1, 0.5}) {
    const TwoLayers layers = two_layers(0, sigma);
    EXPECT_GT(layers.deviation, 0.2 * layers.gap) << sigma;
  }
}

// Heights that a quadratic and two offsets explain to the last digit are fitted so, whichever points are on which layer.
TEST(TwoLayers, ExactOnesLeaveNothing) {
  shapes::Random random(9);
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    points.push_back({x, y, 0.2 * x * x - 0.1 * x * y + 0.05 * y + (i % 3 == 0 ? 0.7 : 0)});
  }
  points.front() = {0, 0, 0.7};
  std::vector<std::uint32_t> index(points.size());
  std::iota(index.begin(), index.end(), std::uint32_t{0});
  std::size_t last = 1;
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (std::hypot(points[k][0], points[k][1], points[k][2] - 0.7) > std::hypot(points[last][0], points[last][1], points[last][2] - 0.7))
      last = k;
  }
  std::swap(index[last], index.back());
  const TwoLayers layers = fit_two_layers(points, index.data(), index.size(), {0, 0, 1});
  EXPECT_NEAR(layers.gap, 0.7, 1e-6);
  EXPECT_LT(layers.deviation, 1e-6);
}

// Either side of the plane may be up.
TEST(TwoLayers, DoNotDependOnTheSideOfTheNormal) {
  shapes::Random random(6);
  std::vector<Vec3> points{{0, 0, 0}};
  for (int i = 1; i < 24; ++i)
    points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), (i % 2 == 0 ? 0.5 : 0) + 0.04 * random.normal()});
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  Neighbours(points).nearest({0, 0, 0}, points.size(), index, squared);
  const TwoLayers one = fit_two_layers(points, index.data(), index.size(), {0, 0, 1});
  const TwoLayers other = fit_two_layers(points, index.data(), index.size(), {0, 0, -1});
  EXPECT_NEAR(one.gap, 0.5, 0.1);
  EXPECT_NEAR(other.gap, one.gap, 1e-9);
  EXPECT_NEAR(other.deviation, one.deviation, 1e-9);
}

}  // namespace
}  // namespace g3r
