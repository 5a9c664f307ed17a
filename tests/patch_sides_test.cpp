// What hints make of patches: what people know decides sides that are open.
#include "orient/patch_sides.h"

#include "orient/confidence.h"
#include "sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

using sides::between;
using sides::dot;
using sides::Sides;

// An open surface whose side is a choice faces the sensor, normals and area vectors alike, and is as sure as its votes agree.
TEST(DecidePatches, APatchFacesTheSensor) {
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

// Every patch has its own vote, so that parts that a depth jump separates face the sensor together.
TEST(DecidePatches, PatchesVoteOneByOne) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({0, 0, 5}, 2, 1, 1);
  sides.add_square({3, 0, 2}, 0, 1, 2);
  const Vec3 sensor{0, 0, 2};
  (void)sides.follow({.sensors = {sensor}});
  for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], between(sides.points[i], sensor)), 0);
}

// Up decides a canopy over a floor with a chance of two thirds, as it may have been seen from below; a sensor decides it for certain.
TEST(DecidePatches, UpSaysLessOfWhatLiesOverOthers) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, -1, 0);
  sides.add_square({0, 0, 2}, 2, -1, 1);
  std::vector<std::uint8_t> over(sides.points.size(), 0);
  std::fill(over.begin() + 400, over.end(), std::uint8_t{1});
  const Hints hints{.up = Vec3{0, 0, 1}};
  const HintEffect effect =
      follow_hints({sides.points, {}, sides.spacing, sides.patches, hints, {sides.normals, sides.eta, sides.confidence}, {}, over});
  EXPECT_EQ(std::count(effect.turned.begin(), effect.turned.end(), 1), 800);
  EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), 800);
  EXPECT_EQ(sides.confidence.front(), 1);
  EXPECT_FLOAT_EQ(sides.confidence.back(), 2.0F / 3);
}

// A patch that up says nothing of keeps its side and its confidence; one that it does faces that way.
TEST(DecidePatches, UpTurnsWhatIsNotUpright) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, -1, 0);
  sides.add_square({0, 5, 0}, 0, -1, 1);
  const HintEffect effect = sides.follow({.up = Vec3{0, 0, 7}});
  EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, 1}));
  EXPECT_EQ(sides.normals.back(), (Vec3{-1, 0, 0}));
  EXPECT_EQ(sides.confidence.back(), 0.5F);
  EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), 400);
}

// An open surface faces away from what is inside.
TEST(DecidePatches, APatchFacesAwayFromInside) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  (void)sides.follow({.inside = {{0, 0, 1}}});
  EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, -1}));
}

// The votes of a patch that bends back disagree, and its confidence is the share of those that agree, or what a point is seen by itself;
// below two thirds it stays a choice.
TEST(DecidePatches, ConfidenceIsTheAgreementOfTheVotes) {
  for (const double least_z : {-0.5, -0.9}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1, least_z, 0, true);
    const HintEffect effect = sides.follow({.up = Vec3{0, 0, 1}});
    const double agreement = 1 / (1 + least_z * least_z);  // integrals of |z| above and below 0
    for (std::size_t i = 0; i < sides.points.size(); ++i) {
      const double chance = std::max(agreement, (1 + sides.normals[i][2]) / 2);
      EXPECT_NEAR(sides.confidence[i], chance, 0.01) << i;
      if (std::abs(chance - 2.0 / 3) > 0.01) {
        EXPECT_EQ(effect.decided[i] != 0, chance > 2.0 / 3) << i;
      }
    }
    for (std::size_t i = 0; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], sides.points[i]), 0.9);
  }
}

// The confidence of a side is that of its patch, times how far it is that side.
TEST(DecidePatches, PointsThatDoNotAgreeWithTheirPatchHaveLessConfidence) {
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

// Up says nothing of the walls, whose sides are those of the ground as surely as they are held together with it.
TEST(DecidePatches, WhatIsSeenEdgeOnIsAsSureAsItIsHeld) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({5, 0, 0}, 0, 1, 0);
  sides.patches.held.assign(800, 1);
  std::fill(sides.patches.held.begin() + 400, sides.patches.held.end(), 0.75F);
  Sides squarely = sides;
  (void)sides.follow({.up = Vec3{0, 0, 1}});
  EXPECT_EQ(sides.confidence.front(), 1);
  EXPECT_FLOAT_EQ(sides.confidence.back(), 0.75F);
  std::fill(squarely.patches.held.begin() + 400, squarely.patches.held.end(), 0.6F);
  Sides hardly = squarely;
  const HintEffect effect = hardly.follow({.up = Vec3{0, 0, 1}});
  EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), 400);  // not what is hardly held
  (void)squarely.follow({.sensors = {{1000, 0, 1000}}});                        // which sees both at 45 degrees
  EXPECT_NEAR(squarely.confidence.back(), (1 + std::sqrt(0.5)) / 2, 0.01);
}

// What a camera has seen at a grazing angle faces it: a doubt, but no choice, unless the camera is known of some points only.
TEST(DecidePatches, NoSideOfWhatHasAllBeenSeenIsAChoice) {
  for (const bool seen : {false, true}) {
    Sides sides;
    sides.add_square({0, 0, 0}, 2, -1, 0);
    sides.patches.held.assign(400, 0.6F);
    sides.patches.seen = seen;
    const HintEffect effect = sides.follow({.sensors = {{8, 0, 1}}});
    EXPECT_EQ(std::count(effect.decided.begin(), effect.decided.end(), 1), seen ? 400 : 0);
    EXPECT_EQ(sides.normals.front(), (Vec3{0, 0, 1}));
    EXPECT_LT(sides.confidence.front(), 2.0F / 3);
  }
}

// Several hints that agree are no surer than sure.
TEST(DecidePatches, NoConfidenceIsAboveOne) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  (void)sides.follow({.up = Vec3{0, 0, 1}, .sensors = {{0, 0, 5}}, .inside = {{0, 0, -5}}});
  for (const float c : sides.confidence) EXPECT_EQ(c, 1);
}

// Votes that are balanced, as those of up on a ball are, leave what the points show; against it they need more than that.
TEST(DecidePatches, WhatThePointsShowStaysUnlessVotesOutweighIt) {
  for (const float certainty : {0.55F, 0.65F}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1, -0.8, 0, true);
    std::fill(sides.patches.certainty.begin(), sides.patches.certainty.end(), certainty);
    const double against = 1 / (1 + 0.64);
    (void)sides.follow({.up = Vec3{0, 0, -1}});
    const bool is_turned = against > static_cast<double>(certainty);
    EXPECT_EQ(sides.normals.front()[2] < 0, is_turned);
    EXPECT_NEAR(sides.confidence[0], is_turned ? (1 + std::abs(sides.normals[0][2])) / 2 : both_say(certainty, 1 - against), 0.02);
  }
}

// What a scanner has seen it has seen from the front: a point that faces away from it has the wrong side, or the wrong direction.
TEST(DecidePatches, WhatFacesAwayFromEveryScannerIsDoubted) {
  Sides above;
  above.add_sphere({0, 0, 0}, 1, -0.5, 0, true);
  Sides around = above;
  above.follow({.sensors = {{0, 0, 1000}}});
  around.follow({.sensors = {{0, 0, 1000}, {0, 0, -1000}}});
  for (std::size_t i = 0; i < above.points.size(); ++i) {
    const double z = above.normals[i][2];
    if (std::abs(z) < 0.01) continue;  // seen edge-on
    const double of_patch = 1 / (1 + 0.25);
    EXPECT_NEAR(above.confidence[i], z < 0 ? (1 + z) / 2 : std::max(of_patch, (1 + z) / 2), 0.01) << z;
    EXPECT_GE(around.confidence[i], kUndecided) << z;  // one of two has seen it from the front
  }
}

// Of one view every point is seen from the front: what would be seen squarely from behind is turned, as surely as it is seen squarely.
TEST(DecidePatches, OfOneViewNothingIsSeenSquarelyFromBehind) {
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
    const double agreement = 1 / (1 + 0.81);
    const double shown = z < 0 ? std::min((z < -0.2236 ? 1 - z : 1 + z) / 2, agreement) : std::max((1 + z) / 2, agreement);
    EXPECT_NEAR(sides.confidence[i], shown, 0.01) << z;
  }
}

// What faces away from every scanner is turned where its patch holds it less than that.
TEST(DecidePatches, WhatFacesAwayAndIsNotHeldIsTurned) {
  Sides sides;
  sides.add_sphere({0, 0, 0}, 1, -0.5, 0, true);
  const std::vector<Vec3> outward = sides.normals;
  for (const Vec3& n : outward) sides.patches.held.push_back(n[0] > 0 ? 1.0F : 0.7F);
  const HintEffect effect = sides.follow({.sensors = {{0, 0, 1000}}});
  for (std::size_t i = 0; i < outward.size(); ++i) {
    const double z = outward[i][2];
    if (std::abs(z) < 0.01 || std::abs(z + 0.4) < 0.01) continue;  // edge-on, and at the limit
    EXPECT_EQ(effect.turned[i] != 0, outward[i][0] <= 0 && 0.7 + (1 + z) / 2 < 1) << z;
    EXPECT_LE(sides.confidence[i], z < 0 ? (1 + std::abs(z)) / 2 + 0.01 : 1) << z;
  }
}

// Where the points decide the side of a patch, it takes two thirds of the votes to turn it.
TEST(DecidePatches, AKnownSideIsTurnedByTwoThirds) {
  for (const double least_z : {-0.5, -0.9}) {
    Sides sides;
    sides.add_sphere({0, 0, 0}, 1, least_z, 0, false);
    (void)sides.follow({.up = Vec3{0, 0, -1}});
    EXPECT_EQ(sides.normals.front()[2] < 0, least_z == -0.5);
    EXPECT_EQ(sides.confidence.back(), 1);
  }
}

// Pieces of one patch that are not consistent with each other all face the sensor; what is seen from behind but goes on into what is
// seen from the front stays consistent with it.
TEST(DecidePatches, PiecesOfAPatchAgree) {
  Sides sides;
  sides.add_square({0, 0, 0}, 2, 1, 0);
  sides.add_square({2.05, 0, 0.3}, 2, -1, 0);
  sides.add_sphere({-2.1, 0, 0}, 1, -0.5, 0, true);
  (void)sides.follow({.sensors = {{0, 0, 9}}});
  for (std::size_t i = 0; i < 800; ++i) EXPECT_EQ(sides.normals[i], (Vec3{0, 0, 1})) << i;
  for (std::size_t i = 800; i < sides.points.size(); ++i) EXPECT_GT(dot(sides.normals[i], between({-2.1, 0, 0}, sides.points[i])), 0.9);
}

// A wall beside the ground that is all but upright: what holds it says more of its side than up does.
TEST(DecidePatches, APieceIsTurnedByVotesThatOutweighWhatHoldsIt) {
  for (const double held : {0.5, 0.75, 1.0}) {
    for (const double lean : {0.05, 0.8}) {
      Sides sides;
      sides.add_square({0, 0, 0}, 2, 1, 0);
      sides.add_square({5, 0, 0}, 0, 1, 0);
      for (std::size_t i = 400; i < 800; ++i) sides.normals[i] = {std::sqrt(1 - lean * lean), 0, -lean};
      sides.patches.held.assign(800, 1);
      std::fill(sides.patches.held.begin() + 400, sides.patches.held.end(), static_cast<float>(held));
      const HintEffect effect = sides.follow({.up = Vec3{0, 0, 1}});
      // Two votes of the chances (1 - lean) / 2 and `held`; what is joined by nothing and leans far goes over in any case.
      const bool is_turned = (1 - lean) / 2 + held < 1 || lean > 0.5;
      EXPECT_EQ(effect.turned[600] != 0, is_turned) << held << ' ' << lean;
      if (!is_turned) {
        EXPECT_NEAR(sides.confidence[600], both_agree(1 / (1 + lean), held), 1e-6) << lean;
      } else {
        EXPECT_NEAR(sides.confidence[600], std::max(1 - held, (1 + lean) / 2), 1e-6) << held;
      }
    }
  }
}

// What stands in a room is seen from where the scanner was, which is not the middle of what it saw.
TEST(DecidePatches, TheMiddleOfARoomSaysNothingOfWhatStandsInIt) {
  Sides room;
  for (const std::size_t axis : {0U, 1U, 2U}) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 centre{0, 0, 0};
      centre[axis] = side;
      room.add_square(centre, axis, -side, 0);
    }
  }
  const std::size_t walls = room.points.size();
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) room.add({0.5, 0.1 * i - 0.35, 0.1 * j - 0.35}, {1, 0, 0}, 0, true);
  }
  room.patches.held.assign(room.points.size(), 1);
  std::fill(room.patches.held.begin() + static_cast<std::ptrdiff_t>(walls), room.patches.held.end(), 0.9F);
  (void)room.follow({.seen_from_inside = true});
  EXPECT_EQ(room.normals.front(), (Vec3{1, 0, 0}));
  EXPECT_EQ(room.normals.back(), (Vec3{1, 0, 0}));
  EXPECT_LE(room.confidence.back(), 0.9F);
}

// A thing on the ground that normals of the crevice between them lead into from behind faces the sensor too; few points are between.
TEST(DecidePatches, WhatIsJoinedByACreviceAloneFacesTheSensor) {
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

// The middle of a flat cloud lies in its plane, however that is turned: it sees neither side.
TEST(DecidePatches, SeenFromInsideSaysNothingOfAPlane) {
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

}  // namespace
}  // namespace g3r
