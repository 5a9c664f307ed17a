// Which side of an open surface is outside: the one that its own field says, part by part, and group by group where little holds them.
#include "orient/outside.h"

#include "base/vector.h"
#include "cloud/point_set.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r {
namespace {

// A level square of side 4 at z = 0 that faces up, then a ball of radius 0.5 that stands `gap` above its middle and faces out.
shapes::Surface ball_above_ground(double gap) {
  shapes::Random random(3);
  shapes::Surface s;
  for (int i = 0; i < 4000; ++i) {
    s.points.push_back({random.uniform(-2, 2), random.uniform(-2, 2), 0});
    s.normals.push_back({0, 0, 1});
  }
  const shapes::Surface ball = shapes::sphere(800);
  for (const Vec3& n : ball.points) {
    s.points.push_back({0.5 * n[0], 0.5 * n[1], 0.5 * n[2] + 0.5 + gap});
    s.normals.push_back(n);
  }
  return s;
}

struct Faced {
  OpenSurfaces surfaces;
  std::vector<Vec3> normals;
};

// All parts are called open, and enclose what they do.
Faced face(const std::vector<Vec3>& points, std::vector<Vec3> normals) {
  const PointSet set(points);
  const SiteParts parts(set, 0, SumPlan{}, nullptr);
  std::vector<double> enclosure(parts.count());
  std::vector<Vec3> at(parts.sites().size());
  for (std::size_t i = 0; i < normals.size(); ++i) at[parts.sites().site_of[i]] = normals[i];
  for (std::size_t p = 0; p < parts.count(); ++p) enclosure[p] = parts.enclosure(parts.members(p), at);
  const std::size_t n = points.size();
  OpenSurfaces found;
  found.part.assign(n, OpenSurfaces::kNone);
  found.certainty.assign(n, 1);
  found.held.assign(n, 1);
  face_outside(parts, std::vector<std::uint8_t>(parts.count(), 1), enclosure, normals, found);
  return {found, normals};
}

double share_right(const Faced& faced, const shapes::Surface& truth, std::size_t first, std::size_t last) {
  double right = 0;
  for (std::size_t i = first; i < last; ++i) right += vector::dot(faced.normals[i], truth.normals[i]) > 0 ? 1 : 0;
  return right / static_cast<double>(last - first);
}

// Whatever the sides that agreement gave to the two, which only a few pairs of points across the gap hold together.
TEST(FaceOutside, ABallBesideTheGroundIsAPartOfItsOwn) {
  const shapes::Surface scene = ball_above_ground(0.08);
  for (const double side : {1.0, -1.0}) {
    std::vector<Vec3> normals = scene.normals;
    for (std::size_t i = 4000; i < normals.size(); ++i) normals[i] = vector::scale(normals[i], side);
    const Faced faced = face(scene.points, normals);
    EXPECT_GT(share_right(faced, scene, 0, 4000), 0.99) << side;
    EXPECT_GT(share_right(faced, scene, 4000, 4800), 0.99) << side;
    EXPECT_NE(faced.surfaces.part[0], faced.surfaces.part[4700]) << side;
    EXPECT_GT(faced.surfaces.certainty[4700], 0.9F) << side;
    EXPECT_EQ(faced.surfaces.certainty[0], 0.5F) << side;
  }
}

// A dome that is firmly joined to the ground encloses as much, and stays a part of it, turned with it.
TEST(FaceOutside, ADomeOnTheGroundIsNot) {
  shapes::Random random(3);
  shapes::Surface scene;
  while (scene.points.size() < 4800) {
    const double x = random.uniform(-2, 2), y = random.uniform(-2, 2), r = std::hypot(x, y);
    if (r > 0.7) {
      scene.points.push_back({x, y, 0});
      scene.normals.push_back({0, 0, 1});
    } else if (r < 0.69 && random.uniform() < 0.2 / std::sqrt(0.49 - r * r)) {
      scene.points.push_back({x, y, std::sqrt(0.49 - r * r)});
      scene.normals.push_back(vector::normalised(scene.points.back()));
    }
  }
  std::vector<Vec3> down = scene.normals;
  for (Vec3& n : down) n = vector::scale(n, -1);
  const Faced faced = face(scene.points, down);
  EXPECT_GT(share_right(faced, scene, 0, scene.points.size()), 0.999);
  std::size_t others = 0;
  for (const std::uint32_t part : faced.surfaces.part) others += part != faced.surfaces.part[0] ? 1 : 0;
  EXPECT_EQ(others, 0U);
}

// One patch of a plane whose sides are the other way has no more to say of what is up than a chance of a half.
TEST(FaceOutside, APatchThatContradictsItsNeighboursIsHeldByNothing) {
  shapes::Surface scene = ball_above_ground(100);
  scene.points.resize(4000);
  scene.normals.resize(4000);
  std::vector<Vec3> normals = scene.normals;
  const auto is_turned = [&](std::size_t i) { return std::hypot(scene.points[i][0], scene.points[i][1]) < 0.5; };
  for (std::size_t i = 0; i < 4000; ++i) {
    if (is_turned(i)) normals[i][2] = -1;
  }
  const Faced faced = face(scene.points, normals);
  for (std::size_t i = 0; i < 4000; ++i) {
    if (is_turned(i)) {
      EXPECT_EQ(faced.surfaces.held[i], 0.5F) << i;
    }
  }
  const std::vector<float>& held = face(scene.points, scene.normals).surfaces.held;
  for (std::size_t i = 0; i < 4000; ++i) {
    if (std::max(std::abs(scene.points[i][0]), std::abs(scene.points[i][1])) < 1.5) {
      EXPECT_GT(held[i], 0.9F) << i;
    }
  }
}

}  // namespace
}  // namespace g3r
