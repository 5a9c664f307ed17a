// Mixtures of layers: points have the deviation from their own layer, however many there are.
#include "cloud/layers.h"

#include "cloud/neighbours.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// Layers z = offset + 0.01 (x^2 - y^2) of 20 x 20 spacings, one point per squared spacing, scattered; the points nearest to the middle of
// the first one.
double deviation_of_layers(const std::vector<double>& offsets, double sigma, std::size_t neighbours) {
  shapes::Random random(7);
  std::vector<Vec3> points;
  for (const double offset : offsets) {
    for (int i = 0; i < 400; ++i) {
      const double x = random.uniform(-10, 10), y = random.uniform(-10, 10);
      points.push_back({x, y, offset + 0.01 * (x * x - y * y) + sigma * random.gaussian()});
    }
  }
  const Vec3 centre{0, 0, offsets.front()};
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  Neighbours(points).nearest(centre, neighbours, index, squared);
  return layered_deviation(points, index.data(), index.size(), centre, {0, 0, 1});
}

TEST(Layers, OneLayerHasItsDeviation) {
  for (const double sigma : {0.01, 0.3, 1.0}) EXPECT_NEAR(deviation_of_layers({0}, sigma, 256) / sigma, 1, 0.15) << sigma;
}

TEST(Layers, LayersFourDeviationsApartCountAsLayers) {
  for (const double sigma : {0.3, 0.6}) {
    EXPECT_NEAR(deviation_of_layers({0, 4 * sigma}, sigma, 256) / sigma, 1, 0.2) << sigma;
    EXPECT_NEAR(deviation_of_layers({0, 4 * sigma, -4 * sigma}, sigma, 256) / sigma, 1, 0.2) << sigma;
  }
}

// A layer 8 deviations away is cut by the ball of the neighbours.
TEST(Layers, LayersThatTheBallCutsDoNotLowerIt) { EXPECT_NEAR(deviation_of_layers({0, 6.5}, 0.8, 256) / 0.8, 1, 0.12); }

TEST(Layers, NoDeviationIsNone) {
  EXPECT_LT(deviation_of_layers({0}, 0, 64), 1e-6);
  EXPECT_LT(deviation_of_layers({0, 1}, 0, 128), 1e-3);
}

// The deviation is a length: it goes with the unit of the points.
TEST(Layers, DeviationGoesWithTheUnit) {
  shapes::Random random(5);
  std::vector<Vec3> points, scaled;
  for (int i = 0; i < 100; ++i) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), (i % 2 == 0 ? 0.4 : 0) + 0.05 * random.gaussian()};
    points.push_back(p);
    scaled.push_back({8 * p[0], 8 * p[1], 8 * p[2]});
  }
  std::vector<std::uint32_t> index;
  std::vector<double> squared;
  Neighbours(points).nearest({0, 0, 0}, points.size(), index, squared);
  const double one = layered_deviation(points, index.data(), index.size(), {0, 0, 0}, {0, 0, 1});
  EXPECT_GT(one, 0.03);
  EXPECT_LT(one, 0.07);  // of one layer it would be 0.2
  EXPECT_DOUBLE_EQ(layered_deviation(scaled, index.data(), index.size(), {0, 0, 0}, {0, 0, 1}), 8 * one);
}

}  // namespace
}  // namespace g3r
