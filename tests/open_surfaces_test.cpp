// Surfaces without an inside: sides consistent, directions right, distinguished from solids and from thin walls.
#include "orient/open_surfaces.h"

#include "base/vector.h"
#include "cloud/morton.h"
#include "cloud/plane_fit.h"
#include "cloud/spacing.h"
#include "orient/start.h"

#include "sanitized.h"
#include "shapes.h"

#include <g3r/g3r.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace g3r {
namespace {

using shapes::Surface;

// z = height(x, y) at random places of [-1, 1]^2, facing up; `scatter` along the normal, in spacings. Slopes by differences.
Surface terrain(std::size_t count, const std::function<double(double, double)>& height, double scatter = 0) {
  constexpr double kStep = 1e-6;
  shapes::Random random(5);
  const double noise = scatter * 2 / std::sqrt(static_cast<double>(count));
  Surface s;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-1, 1);
    const double along_x = (height(x + kStep, y) - height(x - kStep, y)) / (2 * kStep);
    const double along_y = (height(x, y + kStep) - height(x, y - kStep)) / (2 * kStep);
    const double size = std::sqrt(1 + along_x * along_x + along_y * along_y);
    const Vec3 n{-along_x / size, -along_y / size, 1 / size};
    const double t = noise * random.gaussian();
    s.points.push_back({x + t * n[0], y + t * n[1], height(x, y) + t * n[2]});
    s.normals.push_back(n);
    s.areas.push_back(4 * size / static_cast<double>(count));
  }
  return s;
}

double flat(double, double) { return 0; }
double saddle(double x, double y) { return 0.5 * (x * x - y * y); }
double hill(double x, double y) { return 0.5 * std::exp(-4 * (x * x + y * y)); }
double waves(double x, double y) { return 0.15 * std::sin(5 * x) * std::cos(4 * y); }

Surface upper_part(const Surface& whole, double least_z) {
  Surface part;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    if (whole.points[i][2] < least_z) continue;
    part.points.push_back(whole.points[i]);
    part.normals.push_back(whole.normals[i]);
    part.areas.push_back(whole.areas[i]);
  }
  return part;
}

// The votes of a valley on a grid say "down" for one in twelve of its points, no more than chance: the convention says up.
TEST(OpenSurfaces, ValleyOfAHeightMapFacesUp) {
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      const double x = i - 29.5;
      const double y = j - 29.5;
      points.push_back({x, y, -8 * std::exp(-(x * x + y * y) / 200)});
    }
  }
  const Orientation o = orient(points);
  EXPECT_TRUE(std::all_of(o.normals.begin(), o.normals.end(), [](const Vec3& n) { return n[2] > 0; }));
  EXPECT_EQ(o.stats.undecided_share, 1);
}

// An object on a table is one surface without an inside: where it faces out the table faces up. Most of its field is at rest, and the
// equations close it with a table that faces down.
TEST(OpenSurfaces, AnObjectStandsOnItsTable) {
  const double broad = 0.5, high = 0.9, low = -0.6;
  for (const double radius : {0.8, 1.1}) {
    shapes::Random random(4);
    Surface scene;
    double tried = 0;  // directions, all over the ellipsoid
    while (scene.points.size() < 6000) {
      const double z = random.uniform(-1, 1), turn = random.uniform(0, 2 * std::numbers::pi), s = std::sqrt(1 - z * z);
      const Vec3 q{s * std::cos(turn) / broad, s * std::sin(turn) / broad, z / high};  // along the normal
      const double size = std::sqrt(vector::dot(q, q));
      ++tried;
      if (high * z < low || random.uniform(0, 1) > broad * size) continue;  // even by area, which goes with that size
      scene.points.push_back({broad * broad * q[0], broad * broad * q[1], high * z});
      scene.normals.push_back(vector::scale(q, 1 / size));
    }
    // Of directions, each of which stands for broad^2 high size 4 pi / tried of area, the share broad size is taken.
    const double per_area = tried / (4 * std::numbers::pi * broad * high);
    const double inner = broad * std::sqrt(1 - low * low / (high * high));
    const auto table = static_cast<std::size_t>(per_area * std::numbers::pi * (radius * radius - inner * inner) / 2);
    for (std::size_t i = 0; i < table; ++i) {
      const double r = std::sqrt(random.uniform(inner * inner, radius * radius)), a = random.uniform(0, 2 * std::numbers::pi);
      scene.points.push_back({r * std::cos(a), r * std::sin(a), low});
      scene.normals.push_back({0, 0, 1});
    }
    const Orientation o = orient(scene.points);
    std::size_t wrong = 0;
    std::size_t sure = 0;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      if (vector::dot(o.normals[i], scene.normals[i]) > 0) continue;
      ++wrong;
      sure += o.confidence[i] > 0.9F ? 1 : 0;
    }
    EXPECT_LT(static_cast<double>(wrong), 0.01 * static_cast<double>(scene.points.size())) << radius;
    EXPECT_EQ(sure, 0U) << radius;
    EXPECT_GT(o.stats.open_share, 0.9) << radius;
  }
}

// The equations alone leave 49 to 51 % of these on the right side, and turn directions by up to 90 degrees.
TEST(OpenSurfaces, TerrainFacesUp) {
  for (const auto& height : {flat, saddle, hill, waves}) {
    const Surface s = terrain(4000, height);
    const Orientation o = orient(s.points);
    EXPECT_EQ(shapes::share_correct(o.normals, s.normals), 1);
    EXPECT_LT(shapes::angle_error(o.normals, s.normals), 1e-3);
    EXPECT_EQ(o.stats.open_share, 1);
    EXPECT_EQ(o.stats.undecided_share, 1);
    EXPECT_FALSE(o.stats.consistent);
    EXPECT_EQ(*std::max_element(o.confidence.begin(), o.confidence.end()), 0.5F);
    const bool warned = std::any_of(o.stats.warnings.begin(), o.stats.warnings.end(),
                                    [](const std::string& w) { return w.find("open: 100 %") != std::string::npos; });
    EXPECT_TRUE(warned);
    double area = 0;
    double true_area = 0;
    for (const double a : o.areas) area += a;
    for (const double a : s.areas) true_area += a;
    EXPECT_NEAR(area / true_area, 1, 0.1);
  }
}

// A wavy cloth of 3 x 4 folded into layers that lie `gap` above each other.
Surface folded_cloth(std::size_t count, int layers, double gap) {
  constexpr double kWide = 3;
  constexpr double kPhase = 5.15;
  shapes::Random random(7);
  const double bend = std::numbers::pi * gap / 2;
  Surface s;
  for (std::size_t i = 0; i < count; ++i) {
    const double along = random.uniform(0, layers * kWide + (layers - 1) * bend);
    const int k = std::min(layers - 1, static_cast<int>(along / (kWide + bend)));
    const double q = along - k * (kWide + bend);
    const double way = k % 2 == 0 ? 1 : -1;
    const double angle = std::max(0.0, q - kWide) / (gap / 2);
    const double x = (way > 0 ? 0 : kWide) + way * (std::min(q, kWide) + gap / 2 * std::sin(angle));
    const double y = random.uniform(0, 4);
    const double along_x = 0.4 * std::cos(2 * x + kPhase) * std::cos(1.3 * y);
    const double along_y = -0.26 * std::sin(2 * x + kPhase) * std::sin(1.3 * y);
    s.points.push_back({x, y, 0.2 * std::sin(2 * x + kPhase) * std::cos(1.3 * y) + k * gap + gap / 2 * (1 - std::cos(angle))});
    const double up = way * std::cos(angle);
    s.normals.push_back(vector::normalised({-way * std::sin(angle) - along_x * up, -along_y * up, up}));
  }
  return s;
}

// Coarser scales take layers five spacings apart for one, and beyond the next layer the field says nothing of their sides.
TEST(OpenSurfaces, FoldedClothHasOneSide) {
  const Surface s = folded_cloth(12000, 3, 0.25);
  const Orientation o = orient(s.points);
  const double share = shapes::share_correct(o.normals, s.normals);
  EXPECT_GT(std::max(share, 1 - share), 0.95);
}

// How often the run solves for all points.
std::ptrdiff_t solves(const Orientation& o) {
  return std::count_if(o.stats.seconds.begin(), o.stats.seconds.end(), [](const auto& stage) { return stage.first == "solve"; });
}

// What noise could hide is a closed surface, or layers that do not fit: not the inside of an open surface whose sides agree. That is solved
// for once.
TEST(OpenSurfaces, NoiseIsNoObstacle) {
  for (const double scatter : {0.0, 0.1, 0.5, 1.5}) {
    const Surface s = terrain(scatter < 1 ? 6000 : 16000, waves, scatter);
    const Orientation o = orient(s.points);
    EXPECT_GE(shapes::share_correct(o.normals, s.normals), 0.999) << scatter;
    EXPECT_LT(shapes::angle_error(o.normals, s.normals), 0.01) << scatter;
    EXPECT_EQ(solves(o), 1) << scatter;
  }
}

// Half of a ball could be the corner of a room: it bends outward, as a choice. More of it has an outside.
TEST(OpenSurfaces, TakeTheOutsideTheEquationsFind) {
  for (const double least : {0.0, -0.2}) {
    const Surface part = upper_part(shapes::sphere(8000), least);
    const Orientation o = orient(part.points);
    EXPECT_EQ(shapes::share_correct(o.normals, part.normals), 1);
    EXPECT_LT(shapes::angle_error(o.normals, part.normals), 1e-3);
    EXPECT_EQ(o.stats.open_share, 1);
    EXPECT_EQ(o.stats.undecided_share, least == 0 ? 1 : 0);
    EXPECT_EQ(o.stats.consistent, least < 0);
  }
}

// What is seen of an object from one place, under noise as large as the spacing, encloses so much that it may be a closed one whose other
// wall the noise hides. It is not called certain then, but the equations of a solid turn whole patches of it, and neighbours know better.
TEST(OpenSurfaces, NoisyBowlsKeepTheSidesOfTheirNeighbours) {
  Surface bowl = upper_part(shapes::ellipsoid(20000, 1, 0.8, 1.3), 0);
  shapes::scatter(bowl, 0.04);
  const Orientation o = orient(bowl.points);
  EXPECT_GE(shapes::share_correct(o.normals, bowl.normals), 0.98);
  EXPECT_FALSE(o.stats.consistent);
}

// A heat sink whose fins are thinner than the noise: each looks like one wall, on which neighbours agree. A third of the sides is wrong;
// whatever the sink is taken for, nothing may be sure of them.
TEST(OpenSurfaces, FinsThinnerThanTheNoiseAreNoSureSides) {
  const double spacing = 0.03;
  for (const std::uint64_t seed : {1, 2, 3}) {
    shapes::Random random(seed);
    Surface sink;
    shapes::append_box(sink, {-0.5, -0.5, -0.3}, {0.5, 0.5, 0}, spacing, random);
    for (int k = 0; k < 8; ++k) {
      const double y = -0.45 + 0.9 * k / 7, half = 0.1 * spacing;
      shapes::append_box(sink, {-0.5, y - half, 0}, {0.5, y + half, 0.5}, spacing, random);
    }
    shapes::scatter(sink, 0.25 * spacing);
    EXPECT_LT(orient(sink.points).stats.confidence_mean, 0.7) << seed;
  }
}

TEST(OpenSurfaces, OfFewPointsNoSideIsSure) {
  const Orientation few = orient(shapes::sphere(29).points);
  EXPECT_LE(*std::max_element(few.confidence.begin(), few.confidence.end()), 0.5F);
  const Orientation some = orient(shapes::sphere(100).points);  // limit_to_evidence()
  EXPECT_LE(*std::max_element(some.confidence.begin(), some.confidence.end()), 0.9F);
  EXPECT_GT(*std::min_element(some.confidence.begin(), some.confidence.end()), 0.8F);
  const Orientation more = orient(shapes::sphere(200).points);
  EXPECT_GT(*std::min_element(more.confidence.begin(), more.confidence.end()), 0.9F);
}

// `count` times the shape, in rows 4 wide and `apart` from each other.
Surface rows_of(const Surface& shape, int count, double apart) {
  Surface all;
  for (int k = 0; k < count; ++k) {
    Surface one = shape;
    const int row = k / 4;
    const int layer = k / 16;
    for (Vec3& p : one.points) p = {p[0] + apart * (k % 4), p[1] + apart * (row % 4), p[2] + apart * layer};
    all = shapes::join(all, one);
  }
  return all;
}

// Alone each is a cloud of too few points. Their sides are a choice, and the field of these patches jumps all the same: a confidence of
// 0.76.
TEST(OpenSurfaces, OfPartsOfFewPointsNoSideIsSure) {
  shapes::Random random(1);
  for (const int side : {3, 4}) {
    Surface patch;
    for (int k = 0; k < side * side; ++k) {
      const int row = k / side;
      patch.points.push_back({0.1 * (k % side + random.uniform(-0.3, 0.3)), 0.1 * (row + random.uniform(-0.3, 0.3)), 0});
      patch.normals.push_back({0, 0, 1});
      patch.areas.push_back(0.01);
    }
    const Surface patches = rows_of(patch, 64, 1.5);
    const Surface scene = shapes::join(patches, shapes::sphere(2000, 1.2, {-6, 0, 0}));
    const Orientation o = orient(scene.points);
    const auto end = o.confidence.begin() + static_cast<std::ptrdiff_t>(patches.points.size());
    EXPECT_LE(*std::max_element(o.confidence.begin(), end), 0.5F) << side;
    EXPECT_GT(*std::min_element(end, o.confidence.end()), 0.9F) << side;
    EXPECT_FALSE(o.stats.consistent) << side;
  }
}

TEST(OpenSurfaces, BeadsBesideALargePartAreSure) {
  const double spacing = 1.2 * std::sqrt(4 * std::numbers::pi / 2000);
  for (const std::size_t count : {40, 100}) {
    const Surface bead = shapes::sphere(count, spacing * std::sqrt(static_cast<double>(count) / (4 * std::numbers::pi)));
    const Surface scene = shapes::join(rows_of(bead, 16, 1.5), shapes::sphere(2000, 1.2, {-6, 0, 0}));
    const Orientation o = orient(scene.points);
    EXPECT_EQ(shapes::share_correct(o.normals, scene.normals), 1) << count;
    EXPECT_GT(*std::min_element(o.confidence.begin(), o.confidence.end()), 0.6F) << count;
    EXPECT_TRUE(o.stats.consistent) << count;
  }
}

TEST(OpenSurfaces, SolidsHaveNone) {
  for (const Surface& s : {shapes::sphere(3000), shapes::torus(5000, 0.6, 0.25, 2),
                           shapes::join(shapes::sphere(4000, 0.8), shapes::sphere(2000, 0.5), true)}) {
    EXPECT_EQ(orient(s.points).stats.open_share, 0);
  }
}

// Alone the sphere is easy; the ground below it makes its equations wrong.
TEST(OpenSurfaces, DoNotDisturbTheSolidsBesideThem) {
  Surface s = terrain(8000, waves);
  for (Vec3& p : s.points) p = {3 * p[0], 3 * p[1], 3 * p[2] - 1.6};
  const Surface scene = shapes::join(s, shapes::sphere(4000));
  const Orientation o = orient(scene.points);
  EXPECT_EQ(shapes::share_correct(o.normals, scene.normals), 1);
  EXPECT_LT(shapes::angle_error(o.normals, scene.normals), 1e-3);
  EXPECT_NEAR(o.stats.open_share, 2.0 / 3, 1e-12);
}

// The solver cannot converge on the ground, which is no reason to doubt the sphere; with a tolerance out of reach nothing converges.
TEST(OpenSurfaces, ConvergenceIsThatOfEveryClosedPart) {
  Surface s = terrain(8000, waves);
  for (Vec3& p : s.points) p = {3 * p[0], 3 * p[1], 3 * p[2] - 1.6};
  Surface scene = shapes::join(s, shapes::sphere(4000));
  EXPECT_TRUE(orient(scene.points).stats.converged);
  Options options;
  options.tolerance = 1e-12;
  EXPECT_FALSE(orient(scene.points, options).stats.converged);
}

// A sphere of radius 1 in the corner of a ground 12 wide, which is solved for alone: with a percentage of its own box, normals turn.
TEST(OpenSurfaces, ThePartsTakeTheEpsilonOfTheWhole) {
  Surface ground = terrain(8000, flat);
  for (Vec3& p : ground.points) p = {6 * p[0] + 4, 6 * p[1] + 4, -1.6};
  const Surface scene = shapes::join(ground, shapes::sphere(2000));
  Options percent;
  percent.epsilon = {Length::Unit::kPercent, 1};
  const Orientation o = orient(scene.points, percent);
  Options same;
  same.epsilon = {Length::Unit::kInput, o.stats.epsilon};
  EXPECT_LT(shapes::angle_error(o.normals, orient(scene.points, same).normals), 1e-9);
}

TEST(OpenSurfaces, TurnWithTheCloudButForTheChoiceOfSide) {
  const Surface s = terrain(3000, waves);
  Surface turned = s;
  for (auto* vectors : {&turned.points, &turned.normals}) {
    for (Vec3& p : *vectors) p = {0.6 * p[0] - 0.8 * p[2], p[1], 0.8 * p[0] + 0.6 * p[2]};
  }
  const double right = shapes::share_correct(orient(turned.points).normals, turned.normals);
  EXPECT_EQ(std::max(right, 1 - right), 1);
}

TEST(OpenSurfaces, AreTheSameForEveryOrderAndNumberOfThreads) {
  const Surface s = terrain(3000, waves);
  Options one;
  one.threads = 1;
  const Orientation o = orient(s.points, one);
  std::vector<Vec3> backwards(s.points.rbegin(), s.points.rend());
  Options three;
  three.threads = 3;
  const Orientation p = orient(backwards, three);
  for (std::size_t i = 0; i < backwards.size(); ++i) {
    ASSERT_EQ(o.normals[i], p.normals[backwards.size() - 1 - i]);
    ASSERT_EQ(o.areas[i], p.areas[backwards.size() - 1 - i]);
  }
}

// A small open surface far away has no part in the equations of the solid, one right below has.
TEST(OpenSurfaces, AreTakenOutOfEquationsThatTheyArePartOf) {
  const auto scene = [](double below, double side) {
    Surface s = terrain(400, waves);
    for (Vec3& p : s.points) p = {side * p[0], side * p[1], side * p[2] - below};
    return orient(shapes::join(s, shapes::sphere(4000)).points);
  };
  EXPECT_EQ(solves(scene(20, 0.5)), 1);
  EXPECT_EQ(solves(scene(1.6, 2)), 2);
}

// Points in canonical order, with their normals.
struct Sorted {
  std::vector<std::uint32_t> order;
  PointSet set;
  std::vector<Vec3> normals;
};

Sorted sorted_as(const Surface& s, const std::vector<Vec3>& normals) {
  Sorted out{morton_order(s.points), {}, {}};
  std::vector<Vec3> points;
  for (const std::uint32_t i : out.order) {
    points.push_back(s.points[i]);
    out.normals.push_back(normals[i]);
  }
  out.set = PointSet(std::move(points));
  return out;
}

OpenSurfaces find(const Surface& s, std::vector<Vec3>& normals, double noise = 0) {
  auto [order, set, sorted] = sorted_as(s, normals);
  OpenSurfaces found = find_open_surfaces(set, noise, sum_plan(1e-2, set.size()), sorted);
  for (std::size_t k = 0; k < sorted.size(); ++k) normals[order[k]] = sorted[k];
  return found;
}

// Normals as the equations leave them: in the surface in places, upside down in others.
TEST(OpenSurfaces, AreFoundWhateverTheGivenNormals) {
  const Surface s = terrain(4000, waves);
  std::vector<Vec3> normals = s.normals;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (s.points[i][0] < -0.2) normals[i] = vector::scale(normals[i], -1);
    if (std::abs(s.points[i][0]) < 0.2) normals[i] = {-1, 0, 0};
  }
  const OpenSurfaces found = find(s, normals);
  EXPECT_EQ(found.part, std::vector<std::uint32_t>(normals.size(), 0));
  EXPECT_EQ(shapes::share_correct(normals, s.normals), 1);
}

// What is said of a part that may be open does not depend on closed ones.
TEST(OpenSurfaces, AreJudgedWithoutTheClosedParts) {
  const Surface ground = terrain(2000, waves);
  Surface ball = shapes::sphere(3000);
  for (Vec3& p : ball.points) p = {p[0] + 5, p[1], p[2]};
  Surface scene = shapes::join(ground, ball);
  std::vector<Vec3> alone = ground.normals;
  std::vector<Vec3> together = scene.normals;
  for (std::size_t i = 0; i < alone.size(); i += 3) alone[i] = together[i] = vector::scale(alone[i], -1);
  const OpenSurfaces by_itself = find(ground, alone);
  const OpenSurfaces beside = find(scene, together);
  EXPECT_EQ(std::count(beside.part.begin(), beside.part.end(), OpenSurfaces::kNone), 3000);
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(together[i], alone[i]) << i;
  EXPECT_EQ(std::count(beside.agrees.begin(), beside.agrees.end(), 1), std::count(by_itself.agrees.begin(), by_itself.agrees.end(), 1));
}

// Random points of both sides of a plate 0.1 spacings thick: the field cannot see its sides, but it is not open.
TEST(OpenSurfaces, ThinWallsAreNone) {
  Surface s = terrain(4000, flat);
  for (std::size_t i = 0; i < s.points.size(); i += 2) s.points[i][2] += 0.1 * 2 / std::sqrt(4000.0);
  std::vector<Vec3> normals(s.points.size(), Vec3{1, 0, 0});
  const OpenSurfaces found = find(s, normals);
  EXPECT_TRUE(std::all_of(found.part.begin(), found.part.end(), [](std::uint32_t part) { return part == OpenSurfaces::kNone; }));
}

// Lines up to 20 times as far apart as their points: a surface across the gaps, nothing within a line.
TEST(OpenSurfaces, ScanLinesAreOneSurface) {
  for (const double ratio : {4.0, 12.0, 20.0}) {
    shapes::Random random(3);
    Surface s;
    for (double y = -1; y < 1; y += 0.005 * ratio) {
      for (double x = -1; x < 1; x += 0.005)
        s.points.push_back({x + 0.0005 * random.gaussian(), y, 0.1 * std::sin(4 * x) + 0.001 * random.gaussian()});
    }
    const Orientation o = orient(s.points);
    EXPECT_TRUE(std::all_of(o.normals.begin(), o.normals.end(), [](const Vec3& n) { return n[2] > 0; })) << ratio;
    EXPECT_EQ(*std::max_element(o.confidence.begin(), o.confidence.end()), 0.5F) << ratio;
  }
}

// A few lines of soundings, a hundred times as far apart as their points: the neighbours across a line are half certain of its side, and
// the equations of nothing.
TEST(OpenSurfaces, FewSoundingLinesAreOneSurface) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    shapes::Random random(seed);
    Surface s;
    for (int line = 0; line < 4; ++line) {
      for (double x = 0; x < 120; x += 0.18)
        s.points.push_back({x, 25 * line + 0.02 * random.gaussian(), 3 * std::sin(0.2 * x + line) + 0.126 * random.gaussian()});
    }
    const Orientation o = orient(s.points);
    EXPECT_TRUE(std::all_of(o.normals.begin(), o.normals.end(), [](const Vec3& n) { return n[2] > 0; })) << seed;
    EXPECT_LE(*std::max_element(o.confidence.begin(), o.confidence.end()), 0.5F) << seed;
  }
}

// Walls of a trench narrower than the distance between the points: sides follow the ground around it.
TEST(OpenSurfaces, GroovesDoNotTurnWhatLiesBehindThem) {
  Surface s = terrain(12000, [](double x, double) { return 0.3 * std::min(1.0, std::sqrt(std::abs(std::sin(6 * x)))); });
  const Orientation o = orient(s.points);
  const double right = shapes::share_correct(o.normals, s.normals);
  EXPECT_GT(right, 0.98);
}

template <class T>
std::vector<T> repeated(int times, const std::vector<T>& values) {
  std::vector<T> all;
  for (int k = 0; k < times; ++k) all.insert(all.end(), values.begin(), values.end());
  return all;
}

// A round column with a dome on a base wider than it, of which the top and the rim have been scanned but not the bottom. The equations turn
// the top of the base down, as if it were an open surface; neighbours agree with the column.
TEST(OpenSurfaces, TheBaseOfAnObjectThatIsOpenBelowFacesUp) {
  if (kSanitized) GTEST_SKIP() << "a whole solve, whose result is what counts";
  const double column = 0.5, base = 0.6, height = 1.5, rim = 0.1;
  shapes::Random random(1);
  shapes::Surface s;
  const std::array<double, 4> areas{2 * column * height, 2 * column * column, base * base - column * column, 2 * base * rim};
  const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
  for (std::size_t part = 0; part < areas.size(); ++part) {
    for (int k = 0; k < static_cast<int>(12000 * areas[part] / all); ++k) {
      const double turn = random.uniform(0, 2 * std::numbers::pi), u = random.uniform(0, 1);
      const double z = part == 1 ? u : 0, r = std::sqrt(1 - z * z);
      const Vec3 out{r * std::cos(turn), r * std::sin(turn), z};
      const double wide = part < 2 ? column : part == 2 ? std::sqrt(column * column + u * (base * base - column * column)) : base;
      const double foot = part == 0 ? u * height : part == 1 ? height : part == 2 ? 0 : -u * rim;
      s.points.push_back({out[0] * wide, out[1] * wide, foot + out[2] * column});
      s.normals.push_back(part == 2 ? Vec3{0, 0, 1} : out);
    }
  }
  EXPECT_GT(shapes::share_correct(orient(s.points).normals, s.normals), 0.98);
}

TEST(OpenSurfaces, AHalfIsAChoiceOnThemAndUnsureElsewhere) {
  OpenSurfaces surfaces;
  EXPECT_EQ(unsure_share(surfaces, repeated<float>(8, {0.4F, 0.5F, 0.6F, 1})), 0.5);
  EXPECT_EQ(unsure_share(surfaces, repeated<float>(7, {0.4F, 0.5F, 0.6F, 1})), 0.25);  // too few to show any side
  surfaces.part = repeated<std::uint32_t>(8, {0, 0, 0, OpenSurfaces::kNone});
  EXPECT_EQ(unsure_share(surfaces, repeated<float>(8, {0.4F, 0.5F, 0.6F, 1})), 0.25);
  EXPECT_EQ(unsure_share(surfaces, repeated<float>(8, {0.6F, 0.5F, 0.6F, 0.5F})), 0.25);
}

// A layer and a ball, of which another cloud has shown that the layer is open and faces down: nothing else would choose that side.
TEST(OpenSurfaces, ThatAreKnownHaveTheSideThatIs) {
  Surface ball = shapes::sphere(3000);
  for (Vec3& p : ball.points) p = {p[0], p[1], p[2] + 3};
  const Surface layer = terrain(4000, waves, 0.02);
  const Surface scene = shapes::join(layer, ball);
  Known known;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    known.open.push_back(i < layer.points.size() ? 1 : 0);
    known.gradient.push_back(known.open[i] != 0 ? Vec3{0, 0, -1} : scene.normals[i]);
  }
  std::vector<std::uint8_t> open;
  const Orientation found = orient_from(scene.points, known, {}, {}, &open);
  EXPECT_EQ(open, known.open);
  double error = 0;  // of 1 - |cos|
  for (std::size_t i = 0; i < open.size(); ++i) {
    const double cosine = vector::dot(found.normals[i], scene.normals[i]);
    EXPECT_TRUE(open[i] != 0 ? cosine < 0 : cosine > 0) << i;
    error += (1 - std::abs(cosine)) / static_cast<double>(open.size());
  }
  EXPECT_LT(error, 0.005);
  EXPECT_NEAR(found.stats.undecided_share, 4.0 / 7, 1e-9);
  EXPECT_GT(found.stats.iterations.size(), 0U);
  known.open.resize(layer.points.size());
  known.gradient.resize(layer.points.size());
  const Stats alone = orient_from(layer.points, known, {}, {}).stats;
  EXPECT_EQ(alone.iterations.size(), 0U);
  EXPECT_TRUE(alone.converged);
}

TEST(PlaneFit, KnowsPlaneAndNoise) {
  shapes::Random random(9);
  const auto fit = [&](const std::function<double(int)>& height) {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> index;
    for (int i = 0; i < 2000; ++i) {
      points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), height(i)});
      index.push_back(static_cast<std::uint32_t>(i));
    }
    return fit_plane(points, index.data(), index.size());
  };
  const PlaneFit plane = fit([](int) { return 0.3; });
  EXPECT_NEAR(std::abs(plane.normal[2]), 1, 1e-12);
  EXPECT_NEAR(plane.residual, 0, 1e-7);
  const PlaneFit noise = fit([&](int) { return 0.02 * random.gaussian(); });
  EXPECT_NEAR(noise.residual, 0.02, 0.001);
  EXPECT_NEAR(noise.flatness, 0.02 * std::sqrt(3.0), 0.003);  // a uniform distribution over [-1, 1] spreads by 1 / sqrt(3)
}

}  // namespace
}  // namespace g3r
