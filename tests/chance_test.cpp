// What chance puts on a slab: exact sums, also where the smallest of their terms are too small for a number.
#include "cloud/chance.h"

#include "cloud/constants.h"
#include "cloud/exact_plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>

namespace g3r {
namespace {

TEST(Chance, OfANormalDistributionIsSymmetric) {
  EXPECT_EQ(normal_distribution(0), 0.5);
  EXPECT_NEAR(normal_distribution(1), 0.8413447460685429, 1e-15);
  for (const double x : {0.3, 2.5, 6.0}) EXPECT_NEAR(normal_distribution(x) + normal_distribution(-x), 1, 1e-15);
}

TEST(ChancesOfAsMany, AreThoseOfABinomial) {
  const std::vector<double> chances = chances_of_as_many(3, 0.5);
  const double expected[] = {1, 7.0 / 8, 4.0 / 8, 1.0 / 8};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(chances[k], expected[k], 1e-15);
  EXPECT_EQ(chances_of_as_many(5, 1), std::vector<double>(6, 1));
}

// The mean is n p, and 1 - P(less) counts the same from the other end.
TEST(ChancesOfAsMany, SumToTheMeanForAnyNumber) {
  for (const std::size_t n : {30UL, 500UL, 5000UL}) {
    for (const double share : {0.02, 0.3, 0.9}) {
      const std::vector<double> chances = chances_of_as_many(n, share);
      double mean = 0;
      for (std::size_t k = 1; k <= n; ++k) mean += chances[k];
      EXPECT_NEAR(mean, static_cast<double>(n) * share, 1e-9 * static_cast<double>(n)) << n << ' ' << share;
      EXPECT_NEAR(chances[1], 1 - std::pow(1 - share, static_cast<double>(n)), 1e-9);
    }
  }
}

// Two to three standard deviations above the mean, not the first that is there.
TEST(ProvingNumber, IsFarAboveTheMeanOfManyPoints) {
  const std::size_t proves = proving_number(500, 0.02, 1);
  EXPECT_GE(proves, 16U);
  EXPECT_LE(proves, 19U);
  EXPECT_EQ(proving_number(3, 0.9, 1000), 4U);  // not even all do
}

// As many as determine the planes of a bend prove one of exact points, however many are looked at, and 4 a plane along a line of sight:
// what find_exact_plane() and find_viewpoint() go by.
TEST(ProvingNumber, OfExactPointsIsThatOfABend) {
  const double by_chance = share_of_ball(kExactScatter / std::sqrt(kPlaneNeighbours / std::numbers::pi));
  constexpr double kPairs = (kPatchNeighbours - 1) * (kPatchNeighbours - 2) / 2.0;
  for (std::size_t n = kPlaneTerms; n <= kPlaneNeighbours; ++n) {
    EXPECT_LE(proving_number(n - kPlaneTerms, by_chance, kPairs) + kPlaneTerms, kQuadraticTerms) << n;
    if (n > kPlaneTerms) {
      EXPECT_EQ(proving_number(n - 2, kExactScatter, kPlaneNeighbours), 2U) << n;
    }
  }
}

TEST(ShareOfBall, IsThatOfASlab) {
  EXPECT_EQ(share_of_ball(0), 0);
  EXPECT_EQ(share_of_ball(1), 1);
  EXPECT_EQ(share_of_ball(2), 1);
  EXPECT_NEAR(share_of_ball(0.5), 0.6875, 1e-15);
}

TEST(IsMajority, IsMoreThanHalf) {
  EXPECT_FALSE(is_majority(5, 10));
  EXPECT_TRUE(is_majority(6, 10));
  EXPECT_FALSE(is_majority(0, 0));
}

}  // namespace
}  // namespace g3r
