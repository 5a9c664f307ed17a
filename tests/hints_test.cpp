// Truths about hints: what people know decides sides that are open, and contradicts closed parts aloud.
#include "orient/hints.h"

#include "cloud/neighbours.h"

#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace g3r {
namespace {

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 between(const Vec3& from, const Vec3& to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }

// Points with sides, and the patches they belong to.
struct Sides {
  std::vector<Vec3> points, normals, eta;
  std::vector<float> confidence;
  Patches patches;
  double spacing = 0.1;

  void add(const Vec3& point, const Vec3& normal, std::uint32_t patch, bool is_choice) {
    points.push_back(point);
    normals.push_back(normal);
    const double area = spacing * spacing;
    eta.push_back({area * normal[0], area * normal[1], area * normal[2]});
    confidence.push_back(is_choice ? 0.5F : 1.0F);
    patches.of.push_back(patch);
    patches.is_choice.push_back(is_choice ? 1 : 0);
  }
  // A square of side 2 about `centre`, along the axes other than `axis`, whose normals are `sign` times that axis.
  void add_square(const Vec3& centre, std::size_t axis, double sign, std::uint32_t patch, bool is_choice = true) {
    Vec3 normal{0, 0, 0};
    normal[axis] = sign;
    for (int i = 0; i < 20; ++i) {
      for (int j = 0; j < 20; ++j) {
        Vec3 p = centre;
        p[(axis + 1) % 3] += 0.1 * i - 0.95;
        p[(axis + 2) % 3] += 0.1 * j - 0.95;
        add(p, normal, patch, is_choice);
      }
    }
  }
  // A sphere, closed, or its part above `least_z` times the radius as a patch.
  void add_sphere(const Vec3& centre, double radius, double least_z = -1, std::uint32_t patch = Patches::kNone, bool is_choice = false) {
    const int count = static_cast<int>(4 * std::numbers::pi * radius * radius / (spacing * spacing));
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), turn = 2.399963 * i;
      const Vec3 n{r * std::cos(turn), r * std::sin(turn), z};
      if (z < least_z) break;
      add({centre[0] + radius * n[0], centre[1] + radius * n[1], centre[2] + radius * n[2]}, n, patch, is_choice);
    }
  }
  HintEffect follow(const Hints& hints) {
    return follow_hints(points, Neighbours(points).of_all(9), spacing, patches, hints, {normals, eta, confidence});
  }
};

// hints: an open surface whose side is a choice faces the sensor, normals and area vectors alike, and is as sure as its votes agree.
TEST(Hints, APatchFacesTheSensor) {
  for (const double z : {-3.0, 3.0}) {
    Sides sides;
    sides.add_square({0, 0, 0}, 2, 1, 0);
    const HintEffect effect = sides.follow({.sensors = {{0.5, 0, z}}});
    for (std::size_t i = 0; i < sides.points.size(); ++i) {
      EXPECT_GT(z * sides.normals[i][2], 0);
      EXPECT_GT(z * sides.eta[i][2], 0);
      EXPECT_EQ(sides.confidence[i], 1);
    }
    EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), 400);
    EXPECT_EQ(std::count(effect.turned.begin(), effect.turned.end(), 1), z < 0 ? 400 : 0);
    EXPECT_EQ(effect.agreement, 1);
  }
}

// hints: every patch has its own vote, so that parts that a depth jump separates face the sensor together.
TEST(Hints, PatchesVoteOneByOne) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({0, 0, 5}, 2, 1, 1);
  sides.add_square({3, 0, 2}, 0, 1, 2);
  const Vec3 sensor{0, 0, 2};
  (void)sides.follow({.sensors = {sensor}});
  for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], between(sides.points[i], sensor)), 0);
}

// hints: a patch that up says nothing of keeps its side and its confidence; one that it does faces that way.
TEST(Hints, UpTurnsWhatIsNotUpright) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, -1, 0);
  sides.add_square({0, 5, 0}, 0, -1, 1);
  const HintEffect effect = sides.follow({.up = Vec3{0, 0, 7}});
  EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, 1}));
  EXPECT_EQ(sides.normals.back(), (Vec3{-1, 0, 0}));
  EXPECT_EQ(sides.confidence.back(), 0.5F);
  EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), 400);
}

// hints: an open surface faces away from what is inside.
TEST(Hints, APatchFacesAwayFromInside) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  (void)sides.follow({.inside = {{0, 0, 1}}});
  EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, -1}));
}

// hints: the votes of a patch that bends back disagree, and its confidence is the share of those that agree; near a half it stays a choice.
TEST(Hints, ConfidenceIsTheAgreementOfTheVotes) {
  for (const double least_z : {-0.5, -0.9}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1, least_z, 0, true);
    const HintEffect effect = sides.follow({.up = Vec3{0, 0, 1}});
    EXPECT_NEAR(sides.confidence[0], 1 / (1 + least_z * least_z), 0.01);  // integrals of |z| above and below 0
    EXPECT_EQ(effect.decided[0] != 0, least_z == -0.5);
    for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], sides.points[i]), 0.9);
  }
}

// hints: where the points decide the side of a patch, it takes two thirds of the votes to turn it.
TEST(Hints, PointsThatDoNotAgreeWithTheirPatchHaveLessConfidence) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, -1, 0);
  sides.patches.agreed.assign(sides.points.size(), 1);
  sides.patches.agreed[7] = 0.25F;
  Hints hints;
  hints.up = Vec3{0, 0, 1};
  static_cast<void>(sides.follow(hints));
  EXPECT_EQ(sides.confidence[6], 1.0F);
  EXPECT_EQ(sides.confidence[7], 0.25F);
}

// What a scanner has seen it has seen from the front: a point that faces away from it has the wrong side, or the wrong direction.
TEST(Hints, WhatFacesAwayFromEveryScannerIsDoubted) {
  Sides above;
  above.add_sphere({0, 0, 0}, 1, -0.5, 0, true);
  Sides around = above;
  above.follow({.sensors = {{0, 0, 1000}}});
  around.follow({.sensors = {{0, 0, 1000}, {0, 0, -1000}}});
  for (std::size_t i = 0; i < above.points.size(); ++i) {
    const double z = above.normals[i][2];
    if (std::abs(z) < 0.01) continue;  // seen edge-on
    if (z < 0) {
      EXPECT_NEAR(above.confidence[i], (1 + z) / 2, 0.01) << z;
    } else {
      EXPECT_EQ(above.confidence[i], above.confidence[0]) << z;
    }
    EXPECT_EQ(around.confidence[i], around.confidence[0]) << z;
  }
}

// Of one view every point is seen from the front: what would be seen squarely from behind is turned, as surely as it is seen squarely.
TEST(Hints, OfOneViewNothingIsSeenSquarelyFromBehind) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1, -0.9, 0, true);
  const std::vector<Vec3> outward = sides.normals;
  sides.patches.seen = true;
  const HintEffect effect = sides.follow({.sensors = {{0, 0, 1000}}});
  for (std::size_t i = 0; i < sides.points.size(); ++i) {
    const double z = outward[i][2];
    if (std::abs(z) < 0.01 || std::abs(z + 0.2236) < 0.01) continue;  // edge-on, and at the limit
    EXPECT_EQ(effect.turned[i] != 0, z < -0.2236) << z;
    EXPECT_EQ(dot(sides.normals[i], outward[i]) < 0, z < -0.2236) << z;
    const double shown = z < -0.2236 ? (1 - z) / 2 : z < 0 ? (1 + z) / 2 : 1;
    EXPECT_NEAR(sides.confidence[i], std::min(shown, 1 / (1 + 0.81)), 0.01) << z;  // and no more than the votes agree
  }
}

TEST(Hints, AKnownSideIsTurnedByTwoThirds) {
  for (const double least_z : {-0.5, -0.9}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1, least_z, 0, false);
    (void)sides.follow({.up = Vec3{0, 0, -1}});
    EXPECT_EQ(sides.normals.front()[2] < 0, least_z == -0.5);
    EXPECT_EQ(sides.confidence.back(), 1);
  }
}

// hints: pieces of one patch that are not consistent with each other all face the sensor; what is seen from behind but goes on into what is
// seen from the front stays consistent with it.
TEST(Hints, PiecesOfAPatchAgree) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({2.05, 0, 0.3}, 2, -1, 0);
  sides.add_sphere({-2.1, 0, 0}, 1, -0.5, 0, true);
  (void)sides.follow({.sensors = {{0, 0, 9}}});
  for (std::size_t i = 0; i < 800; ++i) EXPECT_EQ(sides.normals[i], (Vec3{0, 0, 1})) << i;
  for (std::size_t i = 800; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], between({-2.1, 0, 0}, sides.points[i])), 0.9);
}

// hints: a thing on the ground that normals of the crevice between them lead into from behind faces the sensor too; few points are between.
TEST(Hints, WhatIsJoinedByACreviceAloneFacesTheSensor) {
  Sides sides;
  for (const double x : {-0.95, 0.95}) sides.add_square({x, 0, -1}, 2, 1, 0);
  const Vec3 sensor{-3, 0, 0.5};
  Sides ball;
  ball.add_sphere({0, 0, 0}, 1);
  for (std::size_t i = 0; i < ball.points.size(); ++i) {
    const Vec3& n = ball.normals[i];
    if (dot(n, between(ball.points[i], sensor)) > 0 && n[2] > -0.9) sides.add(ball.points[i], {-n[0], -n[1], -n[2]}, 0, true);
  }
  // From the ground beside the ball to its lower side, turning evenly from up to the inside of the ball.
  for (int k = 0; k <= 12; ++k) {
    const double part = k / 12.0, turn = 0.57 * part;
    sides.add({-0.54, -0.8 * (1 - part), -0.99 + 0.15 * part}, {std::sin(turn), 0, std::cos(turn)}, 0, true);
  }
  (void)sides.follow({.sensors = {sensor}});
  std::size_t away = 0;
  for (std::size_t i = 0; i < sides.points.size(); ++i) {
    away += dot(sides.normals[i], between(sides.points[i], sensor)) < 0 ? 1 : 0;
  }
  EXPECT_LE(away, 13U);
}

// hints: a sensor outside a closed part sees as much of its back as of its front and says nothing, however near it is.
TEST(Hints, ASensorOutsideDoesNotContradictASolid) {
  for (const double distance : {1.2, 3.0, 1e6}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1);
    const HintEffect effect = sides.follow({.sensors = {{0, 0, distance}}});
    EXPECT_EQ(effect.contradicted_share, 0) << distance;
    EXPECT_GT(sides.normals.front()[2], 0.9);
  }
}

// hints: a sensor inside a closed part turns it, and says how much was against it.
TEST(Hints, ASensorInsideTurnsARoom) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1);
  const HintEffect effect = sides.follow({.sensors = {{0.3, 0.2, -0.5}}});
  EXPECT_TRUE(effect.closed_parts_turned);
  EXPECT_EQ(effect.contradicted_share, 1);
  for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_LT(dot(sides.normals[i], sides.points[i]), -0.9);
}

// hints: with the sensor of every point known, a solid scanned from all around agrees with them, and is turned if they are all against it.
TEST(Hints, EveryPointFacesItsOwnSensor) {
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

// hints: sensors of points that a third of the votes are against leave a closed part as it is and are told.
TEST(Hints, AContradictionIsTold) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1);
  Hints hints{.sensors = {{0, 0, 9}}};
  for (std::size_t i = 0; i < sides.points.size(); ++i) hints.sensor_of_point.push_back(sides.points[i][2] > -0.8 ? 0 : kNoSensor);
  const HintEffect effect = sides.follow(hints);
  EXPECT_FALSE(effect.closed_parts_turned);
  EXPECT_GT(effect.contradicted_share, 0.3);
  EXPECT_LT(effect.contradicted_share, 0.5);
}

// hints: a point that is given as inside and lies outside all closed parts is told, and turns nothing.
TEST(Hints, InsideThatIsOutsideIsTold) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1);
  EXPECT_FALSE(sides.follow({.inside = {{0.2, 0, 0}}}).inside_that_is_outside);
  EXPECT_EQ(sides.follow({.inside = {{0.2, 0, 0}, {2, 0, 0}}}).inside_that_is_outside, (Vec3{2, 0, 0}));
  EXPECT_GT(dot(sides.normals.front(), sides.points.front()), 0.9);
}

// hints: seen from inside, a closed room faces in; what stands in an open one keeps its outside, and the walls face the middle.
// The middle of a flat cloud lies in its plane, however that is turned: it sees neither side.
TEST(Hints, SeenFromInsideSaysNothingOfAPlane) {
  Sides plane;
  constexpr Vec3 kNormal{0.48, 0.64, 0.6};
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      const double u = 0.1 * i * i / 20, v = 0.1 * j;
      plane.add({0.8 * u - 0.36 * v, -0.6 * u - 0.48 * v, 0.8 * v}, kNormal, 0, true);
    }
  }
  const HintEffect effect = plane.follow({.seen_from_inside = true});
  EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), 0);
  EXPECT_EQ(plane.confidence, std::vector<float>(400, 0.5F));
}

TEST(Hints, SeenFromInside) {
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

// hints: flip turns everything, after all others.
TEST(Hints, FlipTurnsEverything) {
  Sides sides;
  sides.add_square({0, 0, 5}, 2, 1, 0);
  sides.add_sphere({0, 0, 0}, 1);
  (void)sides.follow({.up = Vec3{0, 0, 1}, .flip = true});
  EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, -1}));
  EXPECT_LT(dot(sides.normals.back(), sides.points.back()), -0.9);
}

// hints: without any nothing happens.
TEST(Hints, NoneChangeNothing) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, -1, 0);
  const std::vector<Vec3> before = sides.normals;
  EXPECT_TRUE(sides.follow({}).turned.empty());
  EXPECT_EQ(sides.normals, before);
}

// hints: what cannot be meant is refused by name.
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
