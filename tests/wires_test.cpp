// Wires are known by the emptiness in their middle, lines by what noise leaves there.
#include "cloud/wires.h"

#include "base/vector.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace g3r {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// Of a knotted curve: a point and the direction in which it goes on, t from 0 to 1.
Vec3 on_knot(double t) {
  const double a = kTurn * t;
  return {std::sin(a) + 2 * std::sin(2 * a), std::cos(a) - 2 * std::cos(2 * a), -std::sin(3 * a)};
}

// Points around the knot: `across` draws the distances from it in two directions across.
template <class Across>
std::vector<Vec3> around_knot(std::size_t count, const Across& across) {
  shapes::Random random(5);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = random.uniform();
    const Vec3 along = vector::normalised(vector::subtract(on_knot(t + 1e-6), on_knot(t - 1e-6)));
    const Vec3 u = vector::normalised(vector::cross(along, {0.3, -0.5, 0.8}));
    const Vec3 v = vector::cross(along, u);
    const auto [a, b] = across(random);
    points.push_back(vector::add(on_knot(t), vector::add(vector::scale(u, a), vector::scale(v, b))));
  }
  return points;
}

std::vector<Vec3> wire(std::size_t count, double radius, double noise) {
  return around_knot(count, [=](shapes::Random& random) {
    const double angle = kTurn * random.uniform();
    return std::pair(radius * std::cos(angle) + noise * random.gaussian(), radius * std::sin(angle) + noise * random.gaussian());
  });
}

TEST(Wires, AreEmptyInTheirMiddle) {
  for (const double radius : {0.02, 0.05}) EXPECT_TRUE(are_wires(PointSet(wire(2000, radius, 0)))) << radius;
  EXPECT_TRUE(are_wires(PointSet(wire(1000, 0.05, 0))));
  EXPECT_TRUE(are_wires(PointSet(wire(2000, 0.05, 0.015))));
}

TEST(Wires, AreNotWhatNoiseMakesOfALine) {
  for (const double noise : {0.001, 0.01, 0.05}) {
    const auto normal = [=](shapes::Random& random) { return std::pair(noise * random.gaussian(), noise * random.gaussian()); };
    EXPECT_FALSE(are_wires(PointSet(around_knot(2000, normal)))) << noise;
    const auto one_way = [=](shapes::Random& random) { return std::pair(noise * random.gaussian(), 0.0); };
    EXPECT_FALSE(are_wires(PointSet(around_knot(2000, one_way)))) << noise;
  }
  EXPECT_FALSE(are_wires(PointSet(wire(2000, 0, 0))));  // a line without noise
}

// Rounding moves points of a line to the corners of cells around it.
TEST(Wires, AreNotWhatRoundingMakesOfALine) {
  const double step = 0.02;
  std::vector<Vec3> points;
  shapes::Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const double x = 20 * random.uniform();
    const auto level = [&] { return step * std::round(random.uniform()); };
    points.push_back({step * std::round(x / step), level(), level()});
  }
  EXPECT_FALSE(are_wires(PointSet(points)));
}

TEST(Wires, AreNotSurfaces) {
  EXPECT_FALSE(are_wires(PointSet(shapes::sphere(3000).points)));
  EXPECT_FALSE(are_wires(PointSet(shapes::torus(3000, 0.6, 0.05, 1).points)));
}

}  // namespace
}  // namespace g3r
