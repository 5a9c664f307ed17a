#include "cloud/heights.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

namespace g3r {
namespace {

// Heights at random places, of a cubic and of what `noise` adds.
template <typename Noise>
std::vector<Vec3> heights(std::size_t count, shapes::Random& random, Noise noise) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    points.push_back({x, y, 0.3 + x - 0.2 * x * y + 0.1 * y * y * y + noise()});
  }
  return points;
}

HeightMoments moments(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> index(points.size());
  std::iota(index.begin(), index.end(), 0U);
  return height_moments(points, index.data(), index.size(), {0, 0, 1}, 0.5);
}

// Means over many patches of noise drawn by draw(random).
template <typename Draw>
HeightMoments mean_moments(std::size_t count, Draw draw) {
  constexpr int kPatches = 4000;
  shapes::Random random(7);
  HeightMoments mean;
  for (int k = 0; k < kPatches; ++k) {
    const HeightMoments m = moments(heights(count, random, [&] { return draw(random); }));
    mean.mean_square += m.mean_square / kPatches;
    mean.excess += m.excess / kPatches;
    mean.correlation += m.correlation / kPatches;
  }
  return mean;
}

// Few points as many: the kurtosis of residuals alone would be 0.5 too small for 16.
TEST(HeightMoments, NormalNoiseHasNoExcessForAnyNumberOfPoints) {
  for (const std::size_t count : {16, 24, 64, 128}) {
    const HeightMoments m = mean_moments(count, [](shapes::Random& random) { return 0.2 * random.normal(); });
    EXPECT_NEAR(m.excess, 0, 0.08) << count;
    EXPECT_NEAR(m.correlation, 0, 0.01) << count;
    EXPECT_NEAR(m.mean_square, 0.04, 0.001) << count;
  }
}

TEST(HeightMoments, TwoWallsHaveTheirShareOfTheVarianceSquared) {
  for (const double half : {0.5, 1.0, 2.0}) {  // standard deviations
    const double share = half * half / (half * half + 1);
    const HeightMoments m =
        mean_moments(128, [&](shapes::Random& random) { return (random.uniform() < 0.5 ? half : -half) + random.normal(); });
    EXPECT_NEAR(m.excess, -2 * share * share, 0.03 + 0.1 * share * share) << half;
    EXPECT_NEAR(m.correlation, 0, 0.01) << half;
    EXPECT_NEAR(m.mean_square, 1 + half * half, 0.02 * (1 + half * half));
  }
}

// -1.2 times q^4 / 144 over the variance squared, and uneven noise the other way.
TEST(HeightMoments, EvenNoiseHasLessAndUnevenNoiseMore) {
  EXPECT_NEAR(mean_moments(128, [](shapes::Random& random) { return random.uniform(-1, 1); }).excess, -1.2, 0.12);
  EXPECT_GT(mean_moments(128, [](shapes::Random& random) { return random.uniform(0.1, 2) * random.normal(); }).excess, 0.5);
}

TEST(HeightMoments, CubicsAreExactAndHaveNone) {
  shapes::Random random(3);
  const HeightMoments m = moments(heights(40, random, [] { return 0; }));
  EXPECT_LT(m.mean_square, 1e-17);
}

// Of many patches what there is; of one patch, and where all patches share their points, two walls may be chance.
TEST(HeightMoments, WallsAreTwoWhereTheMeanExcessIsNoChance) {
  const auto patches = [](double half, std::size_t count) {
    shapes::Random random(11);
    std::vector<HeightMoments> all;
    for (std::size_t k = 0; k < count; ++k) {
      all.push_back(moments(heights(128, random, [&] { return (random.uniform() < 0.5 ? half : -half) + random.normal(); })));
    }
    return all;
  };
  EXPECT_TRUE(mean_excess(patches(1, 100), 100).is_two_walls());
  EXPECT_FALSE(mean_excess(patches(0, 100), 100).may_be_two_walls());
  const MeanExcess shared = mean_excess(patches(1, 100), 2);
  EXPECT_TRUE(shared.may_be_two_walls());
  EXPECT_FALSE(shared.is_two_walls());
  EXPECT_NEAR(shared.error, std::sqrt(50) * mean_excess(patches(1, 100), 100).error, 1e-9);
  EXPECT_FALSE(mean_excess({}, 1).may_be_two_walls());
}

// Of few patches the flatter half does not know how far chance carries their mean: a sphere under little noise has but some.
TEST(HeightMoments, FewPatchesSayNothingOfWalls) {
  const HeightMoments light{1, -1, 0};  // as of two walls
  EXPECT_TRUE(mean_excess(std::vector<HeightMoments>(30, light), 30).is_two_walls());
  EXPECT_FALSE(mean_excess(std::vector<HeightMoments>(29, light), 29).may_be_two_walls());
}

// Twice the square of the correlation, and nothing where neighbours differ.
TEST(HeightMoments, WallsHaveMoreThanShapeExplains) {
  EXPECT_DOUBLE_EQ((MeanExcess{0, 0, 0.5}.of_shape()), -0.5);
  EXPECT_EQ((MeanExcess{0, 0, -0.5}.of_shape()), 0);
  EXPECT_FALSE((MeanExcess{-0.72, 0, 0.5}.may_be_two_walls()));
  EXPECT_TRUE((MeanExcess{-0.73, 0, 0.5}.may_be_two_walls()));
  EXPECT_TRUE((MeanExcess{-0.73, 0.09, 0.5}.is_two_walls()));  // 2.6 standard errors
  EXPECT_FALSE((MeanExcess{-0.73, 0.1, 0.5}.is_two_walls()));
}

// Ground that takes two heights has light tails as two walls have, but neighbours take the same: the correlation is in
// proportion to the share of shape, as far as neighbours are not beyond an edge.
TEST(HeightMoments, StepsInTheGroundAreNoWalls) {
  for (const double noise : {0.02, 0.05, 0.1}) {
    shapes::Random random(17);
    std::vector<HeightMoments> all;
    double shape = 0, square = 0;
    for (int k = 0; k < 200; ++k) {
      const double phase = random.uniform(0, 2 * std::numbers::pi);
      std::vector<Vec3> points = heights(128, random, [&] { return noise * random.normal(); });
      for (Vec3& p : points) p[2] += std::sin(5 * p[0] + phase) > 0 ? 0.25 : -0.25;
      all.push_back(moments(points));
      square += all.back().mean_square;
      shape += all.back().mean_square * all.back().correlation;
    }
    const MeanExcess excess = mean_excess(all, 200);
    EXPECT_LT(excess.mean, -0.2 - 2.5 * excess.error) << noise;  // what two walls have
    EXPECT_FALSE(excess.is_two_walls()) << noise;
    EXPECT_NEAR(shape / square, 0.7 * (1 - noise * noise * 200 / square), 0.03) << noise;
  }
}

// Rounding to steps along the heights has less, and is taken off where it is known.
TEST(HeightMoments, KnownStepsAreTakenOff) {
  shapes::Random random(13);
  double known = 0;
  double unknown = 0;
  constexpr int kPatches = 1000;
  for (int k = 0; k < kPatches; ++k) {
    std::vector<Vec3> points = heights(128, random, [&] { return 0.02 * random.normal(); });
    for (Vec3& p : points) p[2] = std::round(p[2] / 0.25) * 0.25;
    std::vector<std::uint32_t> index(points.size());
    std::iota(index.begin(), index.end(), 0U);
    unknown += height_moments(points, index.data(), index.size(), {0, 0, 1}, 0.5).excess / kPatches;
    known += height_moments(points, index.data(), index.size(), {0, 0, 1}, 0.5, {0, 0, 0.25}).excess / kPatches;
  }
  EXPECT_LT(unknown, -0.8);
  EXPECT_NEAR(known, 0, 0.2);
}

// Whatever the direction of the line and the rounding of its singular equations.
TEST(HeightMoments, PointsOnALineHaveNone) {
  shapes::Random random(3);
  for (const double angle : {0.0, 0.5, std::numbers::pi / 4}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 40; ++i) {
      const double along = random.uniform(-1, 1);
      points.push_back({along * std::cos(angle), along * std::sin(angle), 0.1 * random.normal()});
    }
    const HeightMoments m = moments(points);
    EXPECT_EQ(m.mean_square, 0) << angle;
    EXPECT_EQ(m.excess, 0) << angle;
  }
}

}  // namespace
}  // namespace g3r
