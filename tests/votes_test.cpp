// Votes of single points: cosines towards and from what people know, whatever the distance.
#include "orient/votes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r {
namespace {

const std::vector<Vec3> kPlaces{{0, 0, 0}, {2, 0, 0}};
constexpr Vec3 kUpwards{0, 0, 1};
const std::vector<double> kAll;  // sensors are trusted

// A point of a plane sees a sensor at 60 degrees from its normal under the cosine 1/2, at any distance and from behind with the other sign.
TEST(SeenFrom, IsTheCosineOfTheAngleToTheNormal) {
  for (const double distance : {1e-3, 1.0, 1e6}) {
    const Vec3 place{distance * std::sqrt(0.75), 0, distance / 2};
    EXPECT_NEAR(seen_from(place, {0, 0, 0}, kUpwards), 0.5, 1e-12);
    EXPECT_NEAR(seen_from(place, {0, 0, 0}, {0, 0, -1}), -0.5, 1e-12);
  }
  EXPECT_EQ(seen_from({1, 2, 3}, {1, 2, 3}, kUpwards), 0);
}

TEST(NearestPlaces, AreThoseNearestToAPointOrNone) {
  const std::vector<Vec3> none;
  NearestPlaces of_none(none);
  of_none.find({0, 0, 0}, 2);
  EXPECT_EQ(of_none.count(), 0);
  NearestPlaces nearest(kPlaces);
  nearest.find({0.9, 5, 0}, 1);
  ASSERT_EQ(nearest.count(), 1);
  EXPECT_EQ(nearest.place(0), kPlaces[0]);
  nearest.find({1.1, 5, 0}, 7);
  ASSERT_EQ(nearest.count(), 2);
  EXPECT_EQ(nearest.place(0), kPlaces[1]);
  EXPECT_DOUBLE_EQ(nearest.squared_distance(1), 1.1 * 1.1 + 25);
}

// As densely as each of them samples what it sees.
TEST(Voters, GoBySensorsNearAndFarUnlessThatOfThePointIsKnown) {
  Hints hints;
  hints.sensors = {{0, 0, 1}, {0, 0, -2}};
  const std::vector<Vec3> points{{0, 0, 0}, {0, 0, 1}};
  Voters any(points, hints, kAll);
  EXPECT_DOUBLE_EQ(any.vote(0, kUpwards), (1 - 0.25) / 1.25);
  EXPECT_DOUBLE_EQ(any.vote(0, {0, 0, -1}), -(1 - 0.25) / 1.25);
  EXPECT_EQ(any.vote(1, kUpwards), 0);  // where a sensor stands
  hints.sensor_of_point = {1, kNoSensor};
  Voters known(points, hints, kAll);
  EXPECT_DOUBLE_EQ(known.vote(0, kUpwards), -1);
  EXPECT_EQ(known.vote(1, kUpwards), 0);
}

// Of two sensors in front and behind, equally far away, neither is right.
TEST(Voters, SayNothingOfAWallBetweenThem) {
  Hints hints;
  hints.sensors = {{0, 3, 4}, {0, 3, -4}};
  const std::vector<Vec3> points{{0, 0, 0}};
  EXPECT_NEAR(Voters(points, hints, kAll).vote(0, kUpwards), 0, 1e-15);
}

TEST(Voters, AddUpAllHints) {
  Hints hints;
  hints.up = Vec3{0, 0, 7};
  hints.inside = {{0, 0, -3}};
  Voters voters(kPlaces, hints, kAll);
  EXPECT_DOUBLE_EQ(voters.vote(0, kUpwards), 2);  // up, and away from what is inside
  EXPECT_DOUBLE_EQ(voters.vote(0, {0, 0, -1}), -2);
  EXPECT_EQ(voters.seen(0, kUpwards), 0);  // by no sensor
}

TEST(Voters, TheMiddleStandsForAScannerInside) {
  Hints hints;
  hints.seen_from_inside = true;
  Voters inside(kPlaces, hints, kAll);
  EXPECT_DOUBLE_EQ(inside.seen(0, {1, 0, 0}), 1);
  EXPECT_DOUBLE_EQ(inside.seen(1, {1, 0, 0}), -1);
  hints.sensors = {{0, 0, 5}};
  EXPECT_DOUBLE_EQ(Voters(kPlaces, hints, kAll).seen(0, kUpwards), 1);
}

// What a sensor says counts as far as it is trusted; what is up and inside counts in full.
TEST(Voters, SensorsCountAsFarAsTheyAreTrusted) {
  Hints hints;
  hints.sensors = {{0, 0, 5}, {0, 0, -5}};
  hints.sensor_of_point = {0, 1};
  const std::vector<double> trusted{0.25, 1};
  Voters voters(kPlaces, hints, trusted);
  EXPECT_DOUBLE_EQ(voters.seen(0, kUpwards), 0.25);
  EXPECT_DOUBLE_EQ(voters.seen(1, kUpwards), -5 / std::sqrt(29));
  EXPECT_EQ(voters.trusted(0), 0.25);
  hints.up = Vec3{0, 0, 1};
  EXPECT_DOUBLE_EQ(Voters(kPlaces, hints, trusted).vote(0, kUpwards), 1.25);
}

TEST(Votes, GoAgainstASideWithTheChanceThatTheyAreTrusted) {
  Votes votes;
  for (const double vote : {-1.0, -1.0, 1.0}) votes.add(vote);
  votes.points = 3;
  for (const double trusted : {0.0, 0.5, 1.0}) {
    votes.trusted = 3 * trusted;
    EXPECT_DOUBLE_EQ(votes.chance_against(), 0.5 + trusted / 6);
  }
}

TEST(Votes, SayWhatShareIsAgainstAndNothingEdgeOn) {
  Votes votes;
  EXPECT_EQ(votes.share_against(), 0);
  for (const double vote : {1.0, 0.5, -0.5}) {
    votes.add(vote);
    ++votes.points;
  }
  EXPECT_DOUBLE_EQ(votes.total(), 2);
  EXPECT_DOUBLE_EQ(votes.share_against(), 0.25);
  EXPECT_TRUE(votes.say_something());
  Votes edge_on;
  for (int i = 0; i < 100; ++i) {
    edge_on.add(1e-9);  // of a float, rounding alone is more
    ++edge_on.points;
  }
  EXPECT_FALSE(edge_on.say_something());
}

}  // namespace
}  // namespace g3r
