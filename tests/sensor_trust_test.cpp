// What other points hide from a sensor it has not seen, and so far it is not trusted.
#include "orient/sensor_trust.h"

#include "sides.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace g3r {
namespace {

using sides::Sides;

// The walls of a room of side 2, seen from inside, as one patch.
Sides room() {
  Sides sides;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vec3 centre{0, 0, 0};
      centre[axis] = sign;
      sides.add_square(centre, axis, -sign, 0);
    }
  }
  return sides;
}

// Of the points of some of the squares.
SensorTrust trust_in(const Sides& sides, const std::vector<std::uint32_t>& squares, const Hints& hints) {
  std::vector<std::uint32_t> some;
  for (const std::uint32_t square : squares) {
    for (std::uint32_t i = 400 * square; i < 400 * (square + 1); ++i) some.push_back(i);
  }
  return find_sensor_trust(PointSet(sides.points), some, hints, nullptr);
}

const std::vector<std::uint32_t> kAllWalls{0, 1, 2, 3, 4, 5};

// From inside a room nothing is hidden. From outside the three walls in front hide the three others, which are seen as squarely.
TEST(SensorTrust, IsLostWhereHalfIsHidden) {
  const Sides sides = room();
  const SensorTrust inside = trust_in(sides, kAllWalls, {.sensors = {{0.3, -0.2, 0.1}}});
  EXPECT_EQ(inside.hidden_share, 0);
  EXPECT_EQ(inside.of_sensor, (std::vector<double>{1}));
  const SensorTrust outside = trust_in(sides, kAllWalls, {.sensors = {{50, 50, 50}}});
  EXPECT_NEAR(outside.hidden_share, 0.5, 0.05);
  EXPECT_NEAR(outside.of_sensor[0], 0, 0.1);
  // Together with one inside they may have seen all.
  EXPECT_EQ(trust_in(sides, kAllWalls, {.sensors = {{50, 50, 50}, {0.3, -0.2, 0.1}}}).hidden_share, 0);
}

// Each sensor by its own points, where these are known.
TEST(SensorTrust, IsOfEachSensorWherePointsNameTheirs) {
  const Sides sides = room();
  Hints hints{.sensors = {{0.3, -0.2, 0.1}, {50, 50, 50}}};
  for (std::size_t i = 0; i < sides.points.size(); ++i) hints.sensor_of_point.push_back(i % 3 == 0 ? 1 : 0);
  const SensorTrust trust = trust_in(sides, kAllWalls, hints);
  EXPECT_NEAR(trust.hidden_share, 0.5 / 3, 0.05);
  EXPECT_GT(trust.of_sensor[0], 0.98);
  EXPECT_LT(trust.of_sensor[1], 0.2);
}

// The walls in front are in sight from outside, whatever they hide.
TEST(SensorTrust, IsOfThePointsThatSensorsShouldHaveSeen) {
  const Sides sides = room();
  const Hints outside{.sensors = {{50, 50, 50}}};
  EXPECT_EQ(trust_in(sides, {1, 3, 5}, outside).of_sensor, (std::vector<double>{1}));
  EXPECT_GT(trust_in(sides, {0, 2, 4}, outside).hidden_share, 0.8);  // all but their rims
  EXPECT_EQ(trust_in(sides, {}, outside).hidden_share, 0);
  EXPECT_TRUE(trust_in(sides, kAllWalls, {.up = Vec3{0, 0, 1}}).of_sensor.empty());
}

// A street faces the sensor inside it, surely; one behind a wall hides the other from it, and is told to be in a place that cannot have
// seen the points.
TEST(SensorTrust, ASensorThatCannotHaveSeenThePointsDecidesNothing) {
  Sides sides;
  sides.add_square({-1, 0, 0}, 0, 1, 0);
  sides.add_square({1, 0, 0}, 0, -1, 0);
  sides.add_square({0, 0, -1}, 2, 1, 0);
  for (const bool inside : {true, false}) {
    Options options;
    options.hints.sensors = {inside ? Vec3{0.3, -0.2, 0.1} : Vec3{20, 0, -0.5}};
    const Orientation found = orient(sides.points, options);
    double wrong = 0, sure = 0;
    for (std::size_t i = 0; i < sides.points.size(); ++i) {
      const bool is_wrong = sides::dot(found.normals[i], sides.normals[i]) < 0;
      wrong += is_wrong ? 1 : 0;
      sure += is_wrong && found.confidence[i] > 0.9F ? 1 : 0;
    }
    EXPECT_EQ(sure, 0) << inside;
    if (inside) {
      EXPECT_EQ(wrong, 0);
    }
    EXPECT_EQ(found.stats.consistent, inside);
    EXPECT_EQ(found.stats.hints.hidden_share > 0.25, !inside) << found.stats.hints.hidden_share;
    const auto says = [](const std::string& warning) { return warning.find("cannot be seen from there") != std::string::npos; };
    EXPECT_EQ(std::count_if(found.stats.warnings.begin(), found.stats.warnings.end(), says), inside ? 0 : 1);
  }
}

}  // namespace
}  // namespace g3r
