// How certain sides are: of true solutions, of ones that contradict themselves, of choices, and of what noise hides.
#include "orient/assess.h"

#include "orient/confidence.h"
#include "problems.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace g3r {
namespace {

using problems::prepared;
using problems::solution_of;

constexpr std::size_t kPoints = 1000;

const shapes::Surface& sphere() {
  static const shapes::Surface s = shapes::sphere(kPoints);
  return s;
}

Stats of_a_solve() {
  Stats stats;
  stats.converged = true;
  return stats;
}

bool warns(const Stats& stats, const std::string& of) {
  return std::any_of(stats.warnings.begin(), stats.warnings.end(), [&](const std::string& w) { return w.find(of) != std::string::npos; });
}

float least(const std::vector<float>& confidence) { return *std::min_element(confidence.begin(), confidence.end()); }
float most(const std::vector<float>& confidence) { return *std::max_element(confidence.begin(), confidence.end()); }

// The first `open` points of a problem on an open surface of this certainty, the others on closed ones.
OpenSurfaces open_part(std::size_t open, float certainty) {
  OpenSurfaces surfaces;
  surfaces.part.assign(kPoints, OpenSurfaces::kNone);
  surfaces.certainty.assign(kPoints, 1);
  surfaces.certified.assign(kPoints, 1);
  surfaces.agrees.assign(kPoints, 0);
  surfaces.held.assign(kPoints, 1);
  for (std::size_t i = 0; i < open; ++i) {
    surfaces.part[i] = 0;
    surfaces.certainty[i] = certainty;
    surfaces.agrees[i] = 1;
  }
  return surfaces;
}

TEST(Assess, ATrueSolutionIsSure) {
  const Problem problem = prepared(sphere().points);
  Stats stats = of_a_solve();
  const Oriented found = assess(problem, solution_of(problem, sphere().normals), stats);
  EXPECT_EQ(found.doubt, 0);
  EXPECT_EQ(found.agreed, 0);
  EXPECT_GT(least(found.confidence), 0.95F);
  EXPECT_NEAR(stats.confidence_mean, found.confidence[0], 0.02);
  EXPECT_TRUE(stats.consistent);
  EXPECT_TRUE(stats.warnings.empty());
}

// Area vectors on the other side than the normals of their field: a tenth of them are few, a quarter are many.
TEST(Assess, DoubtIsTheShareThatContradictsItself) {
  const Problem problem = prepared(sphere().points);
  for (const std::size_t turned : {kPoints / 10, kPoints / 4}) {
    Solution solution = solution_of(problem, sphere().normals);
    for (std::size_t i = 0; i < turned; ++i) solution.eta[i] = vector::scale(solution.eta[i], -1);
    Stats stats = of_a_solve();
    const Oriented found = assess(problem, std::move(solution), stats);
    EXPECT_DOUBLE_EQ(found.doubt, static_cast<double>(turned) / kPoints);
    EXPECT_DOUBLE_EQ(stats.confidence_below_half, found.doubt);
    EXPECT_EQ(stats.consistent, found.doubt <= kManyUnsure);
  }
}

TEST(Assess, SurroundingsDoNotCountForDoubt) {
  for (const bool is_wanted_turned : {true, false}) {
    Known known;
    for (std::size_t i = 0; i < kPoints; ++i) known.wanted.push_back((i % 2 == 0) == is_wanted_turned ? 1 : 0);
    const Problem problem = prepared(sphere().points, {}, known);
    Solution solution = solution_of(problem, sphere().normals);
    for (std::size_t i = 0; i < kPoints; i += 2) solution.eta[problem.cloud.point_of[i]] = {0, 0, 0};
    Stats stats = of_a_solve();
    EXPECT_EQ(assess(problem, std::move(solution), stats).doubt, is_wanted_turned ? 1 : 0);
  }
}

TEST(Assess, SidesOfOpenSurfacesAreAsSureAsTheirOutside) {
  const Problem problem = prepared(sphere().points);
  for (const float certainty : {0.5F, 0.6F, 0.7F, 0.9F}) {
    Solution solution = solution_of(problem, sphere().normals);
    solution.open_surfaces = open_part(300, certainty);
    Stats stats = of_a_solve();
    const Oriented found = assess(problem, std::move(solution), stats);
    const bool is_choice = certainty < 2.0F / 3;  // as much as the corner of a room encloses
    EXPECT_DOUBLE_EQ(stats.open_share, 0.3);
    EXPECT_DOUBLE_EQ(stats.undecided_share, is_choice ? 0.3 : 0);
    EXPECT_DOUBLE_EQ(found.agreed, 0.3);
    EXPECT_DOUBLE_EQ(found.doubt, 0.3);  // the equations do not say their side, whatever their outside is
    EXPECT_NEAR(found.confidence[0], certainty, 0.02F);
    EXPECT_GT(found.confidence[999], 0.95F);
    EXPECT_EQ(stats.consistent, !is_choice);
    EXPECT_TRUE(warns(stats, "their sides are consistent"));
  }
}

// What is said of all sides holds for all: those that their surroundings do not show are counted.
TEST(Assess, SaysForHowManySidesNothingIsShown) {
  const Problem problem = prepared(sphere().points);
  for (const std::size_t unshown : {std::size_t{0}, kPoints / 20}) {
    Solution solution = solution_of(problem, sphere().normals);
    solution.open_surfaces = open_part(kPoints, 0.9F);
    for (std::size_t i = 0; i < unshown; ++i) solution.open_surfaces.certified[i] = 0.2F;
    Stats stats;
    (void)assess(problem, std::move(solution), stats);
    EXPECT_TRUE(warns(stats, "their sides are consistent"));
    EXPECT_EQ(warns(stats, "their sides are consistent, but the neighbours of 5 % of the points do not confirm theirs"), unshown > 0);
  }
}

// A sphere seen from its middle has an inside: what is known is that its points face what has seen them.
TEST(Assess, DoesNotSayOfWhatFacesItsSensorsThatItHasNoInside) {
  Options seen;
  seen.hints.sensors = {{0, 0, 0}};
  seen.hints.sensor_of_point.assign(kPoints, 0);
  for (const Options& options : {Options{}, seen}) {
    const Problem problem = prepared(sphere().points, options);
    const bool are_seen = problem.cloud.set.views().known();
    ASSERT_EQ(are_seen, !options.hints.sensors.empty());
    Solution solution = solution_of(problem, sphere().normals);
    solution.open_surfaces = open_part(kPoints, 0.9F);
    Stats stats;
    (void)assess(problem, std::move(solution), stats);
    EXPECT_NE(warns(stats, "without an inside"), are_seen);
    EXPECT_EQ(warns(stats, "as they face what has seen them"), are_seen);
  }
}

TEST(Assess, WhatIsOpenAsAWholeHasConverged) {
  const Problem problem = prepared(sphere().points);
  for (const std::size_t open : {kPoints - 1, kPoints}) {
    Solution solution = solution_of(problem, sphere().normals);
    solution.open_surfaces = open_part(open, 0.5F);
    Stats stats;
    const Oriented found = assess(problem, std::move(solution), stats);
    EXPECT_EQ(stats.converged, open == kPoints);
    EXPECT_EQ(warns(stats, "did not reach its tolerance"), open != kPoints);
  }
}

// A side that nothing shows to be right is a choice on closed parts, and wrong where its neighbours on an open surface are right.
// Said once, of the sides that are returned: not of those that a hint has decided since.
TEST(SummariseSides, AreConsistentWhereNoWarningSaysTheContrary) {
  for (const float confidence : {0.4F, 0.95F}) {
    const OpenSurfaces surfaces = open_part(kPoints / 2, 1);
    const std::vector<float> all(kPoints, confidence);
    Stats stats;
    summarise_sides(surfaces, all, {}, stats);
    warn_of_unsure(surfaces, all, stats);
    EXPECT_NEAR(stats.confidence_mean, confidence, 1e-6);
    EXPECT_EQ(stats.consistent, confidence > 0.5F);
    EXPECT_EQ(warns(stats, "not consistent"), !stats.consistent);
  }
}

// Points whose side is a choice and of which neighbours are no proof either count once; those that a hint has decided are no choice.
TEST(SummariseSides, CountsEveryDoubtfulPointOnce) {
  for (const std::size_t open : {kPoints * 15 / 100, kPoints / 4}) {
    const OpenSurfaces surfaces = open_part(open, 0.5F);
    std::vector<float> confidence(kPoints, 0.95F);
    std::fill(confidence.begin(), confidence.begin() + 100, 0.4F);
    Stats stats;
    summarise_sides(surfaces, confidence, {}, stats);
    EXPECT_DOUBLE_EQ(stats.undecided_share, static_cast<double>(open) / kPoints);
    EXPECT_DOUBLE_EQ(stats.confidence_below_half, 0.1);
    EXPECT_EQ(stats.consistent, open < kPoints / 5);
    std::vector<std::uint8_t> decided(kPoints, 0);
    std::fill(decided.begin() + 100, decided.begin() + 200, std::uint8_t{1});
    summarise_sides(surfaces, confidence, decided, stats);
    EXPECT_DOUBLE_EQ(stats.undecided_share, static_cast<double>(open < 200 ? 100 : open - 100) / kPoints);
    EXPECT_TRUE(stats.consistent);
  }
}

TEST(Assess, OnlyWhatTheFieldCertifiesIsSure) {
  Options without;
  without.without = "certificate";
  for (const Options& options : {Options{}, without}) {
    const Problem problem = prepared(sphere().points, options);
    Solution solution = solution_of(problem, sphere().normals);
    solution.open_surfaces = open_part(300, 0.9F);
    solution.open_surfaces.certified.assign(kPoints, 0);
    Stats stats = of_a_solve();
    const Oriented found = assess(problem, std::move(solution), stats);
    const bool is_certified = options.without.empty();
    EXPECT_FLOAT_EQ(found.confidence[0], is_certified ? 0 : 0.9F);
    EXPECT_NEAR(found.confidence[999], is_certified ? 0.5F : 1, 0.02F);
    EXPECT_DOUBLE_EQ(found.doubt, 0.3);
    EXPECT_EQ(stats.consistent, !is_certified);
  }
}

// Two square walls, 2.5 standard deviations of their noise apart; solved for as one of them, every point of both faces up.
TEST(Assess, NoSideIsSureWhereNoiseHidesWalls) {
  const double apart = 0.02, sigma = 0.5 * apart;
  shapes::Random random(5);
  shapes::Surface walls;
  for (int i = 0; i < 16000; ++i) {
    const double up = i % 2;
    walls.points.push_back({random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), 2.5 * sigma * up + sigma * random.normal()});
    walls.normals.push_back({0, 0, 2 * up - 1});
  }
  Options options;
  options.noise = {Length::Unit::kInput, sigma};
  options.without = "outliers";
  const Problem problem = prepared(walls.points, options);
  Stats as_one = of_a_solve(), as_two = of_a_solve();
  const Oriented one = assess(problem, solution_of(problem, std::vector<Vec3>(walls.points.size(), {0, 0, 1})), as_one);
  EXPECT_TRUE(one.about_walls.is_two_walls());
  EXPECT_EQ(one.doubt, 0);  // the solution agrees with itself
  EXPECT_LE(most(one.confidence), 0.5F);
  EXPECT_FALSE(as_one.consistent);
  EXPECT_TRUE(warns(as_one, "two layers"));
  EXPECT_FALSE(assess(problem, solution_of(problem, walls.normals), as_two).about_walls.is_two_walls());
  EXPECT_FALSE(warns(as_two, "two layers"));
}

}  // namespace
}  // namespace g3r
