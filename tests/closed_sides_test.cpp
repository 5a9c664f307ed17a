// What hints make of closed parts, which they contradict aloud.
#include "orient/closed_sides.h"

#include "sides.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace g3r {
namespace {

using sides::dot;
using sides::Sides;

// A sensor outside a closed part sees as much of its back as of its front and says nothing, however near it is.
TEST(JudgeClosedParts, ASensorOutsideDoesNotContradictASolid) {
  for (const double distance : {1.2, 3.0, 1e6}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1);
    const HintEffect effect = sides.follow({.sensors = {{0, 0, distance}}});
    EXPECT_EQ(effect.contradicted_share, 0) << distance;
    EXPECT_GT(sides.normals.front()[2], 0.9);
  }
}

// A sensor inside a closed part turns it, and says how much was against it.
TEST(JudgeClosedParts, ASensorInsideTurnsARoom) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1);
  const HintEffect effect = sides.follow({.sensors = {{0.3, 0.2, -0.5}}});
  EXPECT_TRUE(effect.closed_parts_turned);
  EXPECT_EQ(effect.contradicted_share, 1);
  for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_LT(dot(sides.normals[i], sides.points[i]), -0.9);
}

// With the sensor of every point known, a solid scanned from all around agrees with them, and is turned if they are all against it.
TEST(JudgeClosedParts, EveryPointFacesItsOwnSensor) {
  for (const double sign : {1.0, -1.0}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1);
    Hints hints{.sensors = {{0, 0, 9}, {0, 0, -9}}};
    for (std::size_t i = 0; i < sides.points.size(); ++i) hints.sensor_of_point.push_back(sides.points[i][2] > 0 ? 0 : 1);
    for (Vec3& n : sides.normals) n = {sign * n[0], sign * n[1], sign * n[2]};
    const HintEffect effect = sides.follow(hints);
    EXPECT_EQ(effect.closed_parts_turned, sign < 0);
    for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], sides.points[i]), 0.9);
  }
}

// Sensors of points that a third of the votes are against leave a closed part as it is and are told.
TEST(JudgeClosedParts, AContradictionIsTold) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1);
  Hints hints{.sensors = {{0, 0, 9}}};
  for (std::size_t i = 0; i < sides.points.size(); ++i) hints.sensor_of_point.push_back(sides.points[i][2] > -0.8 ? 0 : kNoSensor);
  const HintEffect effect = sides.follow(hints);
  EXPECT_FALSE(effect.closed_parts_turned);
  EXPECT_GT(effect.contradicted_share, 0.3);
  EXPECT_LT(effect.contradicted_share, 0.5);
}

// A point that is given as inside and lies outside all closed parts is told, and turns nothing.
TEST(JudgeClosedParts, InsideThatIsOutsideIsTold) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1);
  EXPECT_FALSE(sides.follow({.inside = {{0.2, 0, 0}}}).inside_that_is_outside);
  EXPECT_EQ(sides.follow({.inside = {{0.2, 0, 0}, {2, 0, 0}}}).inside_that_is_outside, 1U);
  EXPECT_GT(dot(sides.normals.front(), sides.points.front()), 0.9);
}

// A place inside a closed part says nothing of an open surface beside it; one that is beneath that, all else.
TEST(JudgeClosedParts, InsideOneOfThemHasNoVoteElsewhere) {
  for (const Vec3& inside : {Vec3{0, 0, 4}, Vec3{0, 0, -3}, Vec3{0, 0, 3}}) {
    Sides sides;
    sides.add_sphere({0, 0, 4}, 0.5);
    sides.add_square({0, 0, 0}, 2, 1, 0);
    const HintEffect effect = sides.follow({.inside = {{0, 0, 4.1}, inside}});
    EXPECT_EQ(effect.inside_that_is_outside.has_value(), inside[2] != 4);
    EXPECT_EQ(effect.decided.back(), inside[2] != 4 ? 1 : 0);
    EXPECT_EQ(sides.normals.back()[2], inside[2] == 3 ? -1 : 1);
  }
}

// Seen from inside, a closed room faces in; what stands in an open one keeps its outside, and the walls face the middle.
TEST(JudgeClosedParts, SeenFromInside) {
  Sides room;
  room.add_sphere({0, 0, 0}, 1);
  EXPECT_EQ(room.follow({.seen_from_inside = true}).contradicted_share, 0);
  EXPECT_LT(dot(room.normals.front(), room.points.front()), -0.9);
  Sides street;
  for (const double sign : {-1.0, 1.0}) {
    street.add_square({3 * sign, 0, 0}, 0, sign, 0);
    street.add_square({0, 3 * sign, 0}, 1, sign, 0);
  }
  street.add_sphere({0, 0, 0}, 0.5);
  (void)street.follow({.seen_from_inside = true});
  for (std::size_t i = 0; i < street.points.size(); ++i) {
    EXPECT_EQ(dot(street.normals[i], street.points[i]) < 0, street.patches.of[i] == 0);
  }
}

// Two unsure squares beside a sure one, seen from above: every second point of one of them, and all of the sure one, face away.
TEST(JudgeClosedParts, UnsurePointsFaceTheSensorsThatSeeThemAndSureOnesKeepTheirSides) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, Patches::kNone, false);
  sides.add_square({3, 0, 0}, 2, 1, Patches::kNone, false);
  sides.add_square({6, 0, 0}, 2, -1, Patches::kNone, false);
  for (std::size_t i = 0; i < 800; ++i) sides.confidence[i] = 0.2F;
  for (std::size_t i = 0; i < 400; i += 2) sides.normals[i] = {0, 0, -1};
  Sides around = sides;
  const HintEffect effect = sides.follow({.sensors = {{3, 0, 20}, {-3, 0, 20}}});
  for (std::size_t i = 0; i < 1200; ++i) {
    EXPECT_EQ(effect.turned[i] != 0, i < 400 && i % 2 == 0) << i;
    EXPECT_EQ(sides.normals[i][2], i < 800 ? 1 : -1) << i;
    EXPECT_EQ(sides.confidence[i] == 1, i >= 800) << i;
    EXPECT_GT(sides.confidence[i], 0.9) << i;
  }
  // Seen from both sides, either side of a point may have been seen.
  around.follow({.sensors = {{3, 0, 20}, {3, 0, -20}}});
  for (std::size_t i = 0; i < 800; ++i) EXPECT_EQ(around.confidence[i], 0.2F) << i;
}

}  // namespace
}  // namespace g3r
