#include "orient/confidence.h"

#include "cloud/spacing.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace g3r {
namespace {

const std::vector<Vec3> kUp(5, Vec3{0, 0, 1});
const std::vector<Vec3> kAreas(5, Vec3{0, 0, 0.25});
const std::vector<double> kJumps(5, 3.0);

TEST(SideConfidence, IsOneWhereAllAgreesAndNoneWhereDirectionsAreOpposite) {
  std::vector<Vec3> eta = kAreas;
  eta[3] = {0, 0, -0.25};
  eta[4] = {0.25, 0, 0};
  const std::vector<float> c = side_confidence(eta, kUp, kJumps, {1});
  EXPECT_EQ(c, (std::vector<float>{1, 1, 1, 0, 0.5F}));
}

TEST(Chances, OfTwoSidesThatAgreeAndOfTwoObservationsOfOne) {
  for (const double c : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    EXPECT_DOUBLE_EQ(both_agree(c, 1), c);
    EXPECT_DOUBLE_EQ(both_agree(c, 0.5), 0.5);  // a choice is all that is left
    EXPECT_DOUBLE_EQ(both_agree(c, 0), 1 - c);
    EXPECT_DOUBLE_EQ(both_say(c, 0.5), c);  // who knows nothing changes nothing
    if (c > 0 && c < 1) {
      EXPECT_NEAR(both_say(c, 1 - c), 0.5, 1e-15);
    }
  }
  EXPECT_NEAR(both_say(0.8, 0.8), 0.64 / 0.68, 1e-15);
}

TEST(SideConfidence, FallsWithAreaAndFieldBelowHalfTheirMedians) {
  std::vector<Vec3> eta = kAreas;
  eta[0][2] = 0.25 * 0.2;
  std::vector<double> jumps = kJumps;
  jumps[1] = 3.0 * 0.25;
  jumps[2] = 3.0 * 0.5;
  const std::vector<float> c = side_confidence(eta, kUp, jumps, {1});
  EXPECT_FLOAT_EQ(c[0], 0.4F);
  EXPECT_FLOAT_EQ(c[1], 0.5F);
  EXPECT_FLOAT_EQ(c[2], 1);
  eta[0] = {0, 0, 0};
  EXPECT_EQ(side_confidence(eta, kUp, jumps, {1})[0], 0);
}

TEST(SideConfidence, DoesNotDependOnUnits) {
  std::vector<Vec3> eta = kAreas;
  eta[2] = {0.01, 0.03, 0.02};
  const std::vector<double> areas{1, 4, 1, 0.25, 1};
  const std::vector<float> c = side_confidence(eta, kUp, kJumps, areas);
  for (Vec3& v : eta) {
    for (double& x : v) x *= 64;  // lengths 8 times as long
  }
  std::vector<double> larger = areas;
  for (double& a : larger) a *= 64;
  EXPECT_EQ(side_confidence(eta, kUp, kJumps, larger), c);
}

// Laplace: after c n of n trials the next succeeds with the chance (c n + 1) / (n + 2).
TEST(LimitToEvidence, IsTheRuleOfSuccessionAboveAHalf) {
  const std::vector<float> shown{1, 0.8F, 0.5F, 0.25F, 0};
  for (const double n : {2.0, 8.0, 1000.0}) {
    std::vector<float> c = shown;
    limit_to_evidence(static_cast<std::size_t>(n) * kSpacingNeighbours, c);
    EXPECT_FLOAT_EQ(c[0], static_cast<float>((n + 1) / (n + 2)));
    EXPECT_FLOAT_EQ(c[1], static_cast<float>((0.8 * n + 1) / (n + 2)));
    EXPECT_EQ(std::vector<float>(c.begin() + 2, c.end()), std::vector<float>(shown.begin() + 2, shown.end()));
  }
}

TEST(SumsOver, OfThePointAloneAreTheVectorsAndOfAllTheirSum) {
  const std::vector<Vec3> v{{1, 2, 2}, {4, 0, 3}, {-1, 0, 0}};
  EXPECT_EQ(sums_over({0, 1, 2}, v).vectors, v);
  EXPECT_EQ(sums_over({0, 1, 2}, v).lengths, (std::vector<double>{3, 5, 1}));
  EXPECT_EQ(sums_over({0, 1, 2, 1, 2, 0, 2, 0, 1}, v).vectors, std::vector<Vec3>(3, Vec3{4, 2, 5}));
  EXPECT_EQ(sums_over({0, 1, 2, 1, 2, 0, 2, 0, 1}, v).lengths, std::vector<double>(3, 9));
}

// Dense points stand for less area, which is no reason for doubt; vectors that cancel are, wherever they are.
TEST(SumsOver, TellHowFarVectorsAreOneDirectionWhateverTheDensity) {
  std::vector<Vec3> eta(6, Vec3{0, 0, 1});
  for (std::size_t i = 0; i < 3; ++i) eta[i][2] = 0.01;
  eta[3][2] = -0.9;
  const std::vector<Vec3> up(6, Vec3{0, 0, 1});
  const Sums sums = sums_over({0, 1, 1, 2, 2, 0, 3, 4, 4, 5, 5, 5}, eta);  // of two points each
  const std::vector<float> c = side_confidence(sums.vectors, up, {}, sums.lengths);
  EXPECT_EQ(c[0], 1);
  EXPECT_EQ(c[2], 1);
  EXPECT_EQ(c[5], 1);
  EXPECT_LT(c[3], 0.2F);
}

TEST(UnsureShare, CountsWhatIsBelowAHalf) { EXPECT_EQ(unsure_share({0, 0.49F, 0.5F, 1}), 0.5); }

}  // namespace
}  // namespace g3r
