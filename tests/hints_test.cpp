// Hints as a whole: turning everything, changing nothing, and what cannot be meant.
#include "orient/hints.h"

#include "sides.h"

#include <g3r/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace g3r {
namespace {

using sides::dot;
using sides::Sides;

// Flip turns everything, after all others.
TEST(Hints, FlipTurnsEverything) {
  Sides sides;
  sides.add_square({0, 0, 5}, 2, 1, 0);
  sides.add_sphere({0, 0, 0}, 1);
  (void)sides.follow({.up = Vec3{0, 0, 1}, .flip = true});
  EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, -1}));
  EXPECT_LT(dot(sides.normals.back(), sides.points.back()), -0.9);
}

// Without any nothing happens.
TEST(Hints, NoneChangeNothing) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, -1, 0);
  const std::vector<Vec3> before = sides.normals;
  EXPECT_TRUE(sides.follow({}).turned.empty());
  EXPECT_EQ(sides.normals, before);
}

// What cannot be meant is refused by name.
TEST(Hints, UnsoundOnesAreRefused) {
  const double nan = std::nan("");
  const auto expect_refusal = [](const Hints& hints, const std::string& words) {
    try {
      require_sound(hints, 3);
      ADD_FAILURE() << words;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  expect_refusal({.up = Vec3{0, 0, 0}}, "up");
  expect_refusal({.up = Vec3{0, nan, 0}}, "up");
  expect_refusal({.sensors = {{nan, 0, 0}}}, "sensor");
  expect_refusal({.inside = {{0, 0, HUGE_VAL}}}, "inside");
  expect_refusal({.sensors = {{0, 0, 0}}, .sensor_of_point = {0, 0}}, "3 points but sensors of 2");
  expect_refusal({.sensors = {{0, 0, 0}}, .sensor_of_point = {0, 1, 0}}, "sensor 1");
  EXPECT_NO_THROW(require_sound({.sensors = {{0, 0, 0}}, .sensor_of_point = {0, kNoSensor, 0}}, 3));
}

}  // namespace
}  // namespace g3r
