// Finishing: trimming, components, simplifying, attributes.
#include "mesh/mesh_finish.h"
#include "mesh/findings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/median.h"
#include "base/vector.h"
#include "field_shapes.h"
#include "mesh/component_support.h"
#include "mesh/field_mesher.h"
#include "mesh/mesh_parts.h"
#include "mesh/simplify.h"
#include "mesh/smooth_rims.h"
#include "mesh/smooth_spacing.h"
#include "mesh_topology.h"
#include "shapes.h"

namespace {

using namespace g3r;
using namespace g3r::testing;

double norm(const Vec3& p) { return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); }

// Spheres of radius 1 and 0.3, far apart, and the points they were made from.
struct TwoSpheres {
  OrientedSample sample = sphere_sample(2000, 1, 1);
  Mesh mesh;
  TwoSpheres() {
    const OrientedSample small = sphere_sample(180, 0.3, 2);
    for (std::size_t i = 0; i < small.points.size(); ++i) {
      sample.points.push_back({small.points[i][0] + 2, small.points[i][1], small.points[i][2]});
      sample.normals.push_back(small.normals[i]);
    }
    const DistanceSampler field([](const Vec3& p) { return std::min(norm(p) - 1, norm({p[0] - 2, p[1], p[2]}) - 0.3); }, 0.1);
    mesh = field_mesh(sample.points, sample.normals, field);
  }
};

// Made once: most tests start from them.
const TwoSpheres& two_spheres() {
  static const TwoSpheres made;
  return made;
}

// For every vertex of the boundary the next one.
std::map<std::uint32_t, std::uint32_t> rim_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [side, count] : sides) {
    if (sides.count({side.second, side.first}) == 0) next[side.first] = side.second;
  }
  return next;
}

// Without normals: none matter where nothing is trimmed at rims.
mesh::OrientedPoints points_of(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals = {}) {
  return {positions, normals, mesh::smooth_spacing(positions)};
}

// Those above 0 and within `radius` of it.
mesh::OrientedPoints upper_half(const OrientedSample& sample, double radius = 10) {
  OrientedSample half;
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    if (sample.points[i][2] <= 0 || norm(sample.points[i]) > radius) continue;
    half.points.push_back(sample.points[i]);
    half.normals.push_back(sample.normals[i]);
  }
  return points_of(half.points, half.normals);
}

void finish(Mesh& mesh, const mesh::OrientedPoints& points, const MeshOptions& options, double noise = 0) {
  mesh::Found nothing;
  mesh::finish_mesh(mesh, points, noise, options, nothing);
}

TEST(MeshFinish, ComponentsAreFoundAndRemoved) {
  TwoSpheres two = two_spheres();
  EXPECT_EQ(topology(two.mesh).components, 2U);
  Mesh one = two.mesh;
  const mesh::Components components = mesh::find_components(one);
  ASSERT_EQ(components.count, 2U);
  std::vector<double> area(2, 0.0);
  for (std::size_t t = 0; t < one.triangles.size(); ++t) area[components.of[t]] += mesh::area_of(one, one.triangles[t]);
  EXPECT_NEAR(std::min(area[0], area[1]), 1.13, 0.03);
  mesh::remove_components(one, components,
                          {area[0] > 2 ? std::uint8_t{1} : std::uint8_t{0}, area[1] > 2 ? std::uint8_t{1} : std::uint8_t{0}});
  EXPECT_EQ(topology(one).components, 1U);
  EXPECT_EQ(topology(one).bad_edges, 0U);
  EXPECT_NEAR(topology(one).volume, 4.0 / 3.0 * M_PI, 0.02);
}

// What noise makes grows with it, so what goes unasked does too.
TEST(MeshFinish, SpuriousComponentsMayBeLargerUnderNoise) {
  TwoSpheres two = two_spheres();
  const double h = median(mesh::smooth_spacing(two.sample.points));
  const double points = 1.13 / (h * h);  // that the small sphere stands for
  const double noise = std::sqrt((points / 8 - 1) / 4);
  const auto components = [&](double times, std::optional<double> least) {
    Mesh mesh = two.mesh;
    MeshOptions options;
    options.min_component = least;
    finish(mesh, points_of(two.sample.points), options, times * noise);
    return topology(mesh).components;
  };
  EXPECT_EQ(components(0, {}), 2U);
  EXPECT_EQ(components(0.9, {}), 2U);
  EXPECT_EQ(components(1.1, {}), 1U);
  EXPECT_EQ(components(1.1, 8), 2U);
  EXPECT_EQ(components(0, 1.1 * points), 1U);
}

// A small thing with many points is not spurious, however large the others' spacing is.
TEST(MeshFinish, ComponentsAreMeasuredByTheirOwnSpacing) {
  TwoSpheres two = two_spheres();
  mesh::OrientedPoints points = points_of(two.sample.points);
  std::fill(points.spacing.begin(), points.spacing.end(), 1.0);  // 1.13 is the area of one such point
  const MeshOptions options;
  Mesh mesh = two.mesh;
  finish(mesh, points, options);
  EXPECT_EQ(topology(mesh).components, 1U);
  std::fill(points.spacing.begin() + 2000, points.spacing.end(), 0.1);
  finish(two.mesh, points, options);
  EXPECT_EQ(topology(two.mesh).components, 2U);
}

TEST(MeshFinish, LargestComponentsAreKept) {
  TwoSpheres two = two_spheres();
  MeshOptions options;
  options.keep_largest = 1;
  finish(two.mesh, points_of(two.sample.points, two.sample.normals), options);
  EXPECT_EQ(topology(two.mesh).components, 1U);
  EXPECT_GT(topology(two.mesh).volume, 4.0);
}

TEST(MeshFinish, TrimmingOpensTheMeshWherePointsAreMissing) {
  TwoSpheres two = two_spheres();
  const mesh::OrientedPoints half = upper_half(two.sample);
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  EXPECT_GT(mesh::far_share(two.mesh, half.positions, 4), 0.3);
  finish(two.mesh, half, options);
  const MeshCheck check = check_mesh(two.mesh);
  EXPECT_FALSE(check.closed);
  EXPECT_TRUE(check.manifold);
  EXPECT_GT(check.boundary_edges, 0U);
  EXPECT_LT(mesh::far_share(two.mesh, half.positions, 4), 0.01);
}

// At a rim trimmed surface ends with its points, and no place of it is farther from them than four spacings of the cloud, even if a sparse
// point far away has a larger spacing of its own.
TEST(MeshFinish, TrimmedSurfaceEndsWithItsPoints) {
  TwoSpheres two = two_spheres();
  mesh::OrientedPoints half = upper_half(two.sample, 1.1);
  const double h = median(half.spacing);
  half.positions.push_back({2, 0, 0.3});  // alone on the small sphere
  half.normals.push_back({0, 0, 1});
  half.spacing.push_back(20 * h);
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  options.keep_largest = 1;
  finish(two.mesh, half, options);
  EXPECT_EQ(topology(two.mesh).components, 1U);
  for (const auto& t : two.mesh.triangles) {
    double z = 0;
    for (const std::uint32_t v : t) z += two.mesh.vertices[v][2] / 3;
    EXPECT_GT(z, -1.2 * h);  // the points end at 0, a gap below it at the most
  }
  EXPECT_NEAR(check_mesh(two.mesh).area, 2 * M_PI, 0.01 * 2 * M_PI);
}

// Steps of the triangulation are no rim: without smoothing it is a third longer, and turns by more than 60 degrees at every third vertex.
TEST(MeshFinish, RimsAreCleanLines) {
  const OrientedSample sphere = sphere_sample(3000, 1, 1);
  const DistanceSampler field([](const Vec3& p) { return norm(p) - 1; }, 0.1);
  Mesh mesh = field_mesh(sphere.points, sphere.normals, field);
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  finish(mesh, upper_half(sphere), options);
  EXPECT_TRUE(check_mesh(mesh).manifold);
  const std::map<std::uint32_t, std::uint32_t> next = rim_of(mesh);
  double length = 0;
  std::size_t sharp = 0;
  for (const auto& [from, to] : next) {
    const Vec3 side = vector::subtract(mesh.vertices[to], mesh.vertices[from]);
    const Vec3 then = vector::subtract(mesh.vertices[next.at(to)], mesh.vertices[to]);
    sharp += vector::dot(vector::normalised(side), vector::normalised(then)) < 0.5 ? 1 : 0;
    length += norm(side);
  }
  EXPECT_LE(sharp, next.size() / 50);  // where a triangle would turn over the rim stays as it is
  EXPECT_NEAR(length, 2 * M_PI, 0.03 * 2 * M_PI);
  const std::vector<Vec3> before = mesh.vertices;
  mesh::smooth_rims(mesh, [](const std::vector<Vec3>& places) { return std::vector<std::uint8_t>(places.size(), 0); });
  EXPECT_EQ(mesh.vertices, before);
}

// Lines eight times as far apart as their points: all between the lines is kept, and nothing far beyond.
TEST(MeshFinish, ThereAreNoSlitsBetweenLines) {
  constexpr double kApart = 8;
  constexpr int kLines = 12, kPoints = 100, kAround = 40;
  std::vector<Vec3> points;
  for (int i = 0; i < kLines; ++i) {
    for (int j = 0; j < kPoints; ++j) points.push_back({double(j), kApart * i, 0});
  }
  Mesh surface;
  constexpr int kWide = kPoints + 2 * kAround, kLong = static_cast<int>(kApart) * kLines + 2 * kAround;
  for (int x = 0; x < kWide; ++x) {
    for (int y = 0; y < kLong; ++y) {
      surface.vertices.push_back({double(x - kAround), double(y - kAround), 0});
      if (x + 1 == kWide || y + 1 == kLong) continue;
      const auto v = static_cast<std::uint32_t>(x * kLong + y);
      surface.triangles.push_back({v, v + kLong, v + kLong + 1});
      surface.triangles.push_back({v, v + kLong + 1, v + 1});
    }
  }
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  finish(surface, points_of(points, std::vector<Vec3>(points.size(), Vec3{0, 0, 1})), options);
  constexpr double kWidth = kPoints - 1, kLength = kApart * (kLines - 1);
  EXPECT_GE(check_mesh(surface).area, kWidth * kLength);
  EXPECT_LE(check_mesh(surface).area, (kWidth + 1.5 * kApart) * (kLength + 1.5 * kApart));
}

// The largest component is the one that points hold, not the one that fills emptiness.
TEST(MeshFinish, LargestIsWhatPointsHold) {
  TwoSpheres two = two_spheres();
  const std::vector<Vec3> small(two.sample.points.begin() + 2000, two.sample.points.end());
  MeshOptions options;
  options.keep_largest = 1;
  finish(two.mesh, points_of(small), options);
  EXPECT_NEAR(check_mesh(two.mesh).area, 1.13, 0.1);
}

// A part that fewer points hold than strays lie beside is chance; one with few strays beside it is a part.
TEST(MeshFinish, PartsAmongStraysAreChance) {
  for (const std::size_t strays : {std::size_t{100}, std::size_t{300}}) {
    TwoSpheres two = two_spheres();
    mesh::Found found;
    for (std::size_t i = 0; i < strays; ++i) {
      const Vec3& p = two.sample.points[2000 + i % 180];
      found.strays.push_back({p[0], p[1], p[2] + 0.02 + 1e-4 * static_cast<double>(i)});
    }
    mesh::finish_mesh(two.mesh, points_of(two.sample.points), 0, {}, found);
    EXPECT_EQ(found.dropped.components, strays == 300 ? 1U : 0U);
    EXPECT_NEAR(found.dropped.area, strays == 300 ? 1.13 : 0, 0.1);
  }
}

TEST(MeshFinish, TrimmingClosedDataChangesNothing) {
  TwoSpheres two = two_spheres();
  const Mesh before = two.mesh;
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  finish(two.mesh, points_of(two.sample.points, two.sample.normals), options);
  EXPECT_EQ(before.triangles, two.mesh.triangles);
}

// A ball in 12 lines, which are more than twice as far apart as the spacing along them would let surface reach.
TEST(MeshFinish, TheWayToTheNextLineIsNoHole) {
  constexpr int kLines = 12, kPerLine = 400;
  OrientedSample lines;
  for (int i = 0; i < kLines; ++i) {
    const double z = 0.97 * (2.0 * i / (kLines - 1) - 1), r = std::sqrt(1 - z * z);
    for (int j = 0; j < kPerLine; ++j) {
      const double angle = 2 * M_PI * j / kPerLine;
      lines.points.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  lines.normals = lines.points;
  Mesh mesh = field_mesh(sphere_sample(4000, 1, 1).points, sphere_sample(4000, 1, 1).normals,
                         DistanceSampler([](const Vec3& p) { return norm(p) - 1; }, 0.1));
  EXPECT_LT(mesh::far_share(mesh, lines.points, 4), 0.01);
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  finish(mesh, points_of(lines.points, lines.normals), options);
  EXPECT_GT(check_mesh(mesh).area, 0.95 * 4 * M_PI);
}

// A half sphere, closed over by large triangles: no corner is farther from the points than asked for, and other places hardly are.
TEST(MeshFinish, NothingIsFartherThanTheTrimDistance) {
  const OrientedSample whole = sphere_sample(4000, 1, 1);
  OrientedSample half;
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    if (whole.points[i][2] < 0) continue;
    half.points.push_back(whole.points[i]);
    half.normals.push_back(whole.normals[i]);
  }
  for (const double distance : {0.12, 0.2, 0.4}) {
    MeshOptions options;
    options.trim = MeshOptions::Trim::kDistance;
    options.trim_distance = distance;
    const Mesh mesh = mesh_oriented(half.points, half.normals, options);
    EXPECT_EQ(mesh::find_components(mesh).count, 1U) << distance;
    const auto from_points = [&](const Vec3& place) {
      double nearest = 9;
      for (const Vec3& p : half.points) nearest = std::min(nearest, norm(vector::subtract(p, place)));
      return nearest;
    };
    for (const Vec3& v : mesh.vertices) ASSERT_LE(from_points(v), 1.001 * distance);
    for (const auto& t : mesh.triangles) ASSERT_LE(from_points(mesh::centre_of(mesh, t)), 1.1 * distance);
  }
}

TEST(MeshFinish, TrimDistanceMustBePositiveAndLeaveSomething) {
  TwoSpheres two = two_spheres();
  MeshOptions options;
  options.trim = MeshOptions::Trim::kDistance;
  EXPECT_THROW(finish(two.mesh, points_of(two.sample.points, two.sample.normals), options), InvalidInput);
  options.trim_distance = 1e-9;
  EXPECT_THROW(finish(two.mesh, points_of(two.sample.points, two.sample.normals), options), InvalidInput);
}

TEST(MeshFinish, TouchingTrianglesAreSeparatedAtTheirCommonVertex) {
  Mesh fan;  // three triangles around vertex 0; without the middle one the others touch at a point
  fan.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 0, 0}};
  fan.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  mesh::remove_triangles(fan, {1, 0, 1});
  EXPECT_EQ(fan.vertices.size(), 6U);
  EXPECT_TRUE(check_mesh(fan).manifold);
}

TEST(MeshFinish, SimplifyingKeepsAClosedManifold) {
  TwoSpheres two = two_spheres();
  const std::size_t before = two.mesh.triangles.size();
  mesh::simplify(two.mesh, before / 5);
  EXPECT_LE(two.mesh.triangles.size(), before / 5);
  EXPECT_GE(two.mesh.triangles.size(), before / 5 - 1);
  const MeshCheck check = check_mesh(two.mesh);
  EXPECT_TRUE(check.closed && check.manifold);
  EXPECT_EQ(check.genus, 0);
  EXPECT_EQ(check.components, 2U);
  EXPECT_NEAR(check.volume, 4.0 / 3.0 * M_PI * 1.027, 0.1);
}

// Handles, holes and thin walls of meshes as they come: the target is met, and nothing but the triangles is fewer.
TEST(MeshFinish, SimplifyingKeepsHandlesAndBoundaries) {
  const shapes::Surface s = shapes::torus(6000, 0.6, 0.2, 2);
  const Mesh whole = mesh_oriented(PointsView(s.points), PointsView(s.normals));
  for (const bool is_cut : {false, true}) {
    Mesh mesh = whole;
    if (is_cut) {
      std::vector<std::uint8_t> keep(mesh.triangles.size(), 1);
      for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = mesh::centre_of(mesh, mesh.triangles[t])[0] < 0.5 ? 1 : 0;
      mesh::remove_triangles(mesh, keep);
    }
    const MeshCheck before = check_mesh(mesh);
    ASSERT_EQ(before.closed, !is_cut);
    mesh::simplify(mesh, 600);
    const MeshCheck after = check_mesh(mesh);
    EXPECT_LE(mesh.triangles.size(), 600U);
    EXPECT_GE(mesh.triangles.size(), 599U);
    EXPECT_TRUE(after.manifold);
    EXPECT_EQ(after.closed, before.closed);
    EXPECT_EQ(after.genus, before.genus);
    EXPECT_EQ(after.components, before.components);
    EXPECT_NEAR(after.area, before.area, 0.02 * before.area);
    for (const Vec3& v : mesh.vertices) EXPECT_NEAR(std::hypot(std::hypot(v[0], v[1]) - 0.6, v[2]), 0.2, 0.01);
  }
}

// The facets of a box, cut into squares: within them every collapse is free, and those that leave triangles without area, along the
// edges of the box, are not taken.
TEST(MeshFinish, SimplifyingFacetsLeavesNoTriangleWithoutArea) {
  constexpr int kCells = 16;
  Mesh box;
  std::map<std::array<int, 3>, std::uint32_t> number;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [place, is_new] = number.try_emplace(at, static_cast<std::uint32_t>(box.vertices.size()));
    if (is_new) box.vertices.push_back({at[0] / 30.0, at[1] / 20.0, at[2] / 10.0});
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int cell = 0; cell < 2 * kCells * kCells; ++cell) {
      const bool is_upper = cell >= kCells * kCells;
      const int i = cell % kCells, j = cell / kCells % kCells;
      std::array<std::uint32_t, 4> square{};
      for (std::size_t k = 0; k < 4; ++k) {
        std::array<int, 3> at{};
        at[axis] = is_upper ? kCells : 0;
        at[(axis + 1) % 3] = i + (k == 1 || k == 2 ? 1 : 0);
        at[(axis + 2) % 3] = j + (k >= 2 ? 1 : 0);
        square[is_upper ? k : 3 - k] = vertex(at);
      }
      box.triangles.push_back({square[0], square[1], square[2]});
      box.triangles.push_back({square[0], square[2], square[3]});
    }
  }
  const MeshCheck before = check_mesh(box);
  ASSERT_TRUE(before.closed && before.manifold);
  for (const std::size_t faces : {1500U, 600U, 200U}) {
    mesh::simplify(box, faces);
    const MeshCheck check = check_mesh(box);
    EXPECT_EQ(box.triangles.size(), faces);
    EXPECT_TRUE(check.closed && check.manifold);
    EXPECT_NEAR(check.volume, before.volume, 1e-12);
    EXPECT_LT(check.max_aspect, 100) << faces;
  }
}

// Fewer than four triangles enclose nothing.
TEST(MeshFinish, SimplifyingLeavesTetrahedraAtLeast) {
  TwoSpheres two = two_spheres();
  mesh::simplify(two.mesh, 1);
  EXPECT_EQ(two.mesh.triangles.size(), 8U);
  EXPECT_TRUE(check_mesh(two.mesh).closed && check_mesh(two.mesh).manifold);
  std::vector<std::string> warnings;
  warn_of_faces(two.mesh.triangles.size(), 1, 0, warnings);
  EXPECT_EQ(warnings.size(), 1U);
  warn_of_faces(two.mesh.triangles.size(), 8, 0, warnings);
  warn_of_faces(two.mesh.triangles.size(), 0, 0, warnings);
  EXPECT_EQ(warnings.size(), 1U);
}

TEST(MeshFinish, ColoursAndConfidenceFollowTheNearestPoints) {
  TwoSpheres two = two_spheres();
  std::vector<std::array<std::uint8_t, 3>> colors;
  std::vector<float> confidence;
  for (const Vec3& p : two.sample.points) {
    colors.push_back(p[2] > 0 ? std::array<std::uint8_t, 3>{255, 0, 10} : std::array<std::uint8_t, 3>{0, 255, 10});
    confidence.push_back(p[2] > 0 ? 1.0F : 0.0F);
  }
  carry_attributes(two.mesh, two.sample.points, colors, confidence);
  ASSERT_EQ(two.mesh.colors.size(), two.mesh.vertices.size());
  ASSERT_EQ(two.mesh.confidence.size(), two.mesh.vertices.size());
  for (std::size_t v = 0; v < two.mesh.vertices.size(); ++v) {
    EXPECT_EQ(two.mesh.colors[v][2], 10);
    if (two.mesh.vertices[v][2] > 0.3) {
      EXPECT_FLOAT_EQ(two.mesh.confidence[v], 1.0F);
    }
    if (two.mesh.vertices[v][2] < -0.3) {
      EXPECT_EQ(two.mesh.colors[v][1], 255);
    }
  }
  EXPECT_THROW(carry_attributes(two.mesh, two.sample.points, {{1, 2, 3}}, {}), InvalidInput);
}

TEST(MeshFinish, ConfidencesThatAreNotFiniteTakeNoPart) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 0, 0}, {9, 1, 0}, {9, 0, 1}, {8, 0, 0}};
  Mesh mesh;
  mesh.vertices = {{0.1, 0.1, 0.1}, {9, 0.1, 0.1}};
  carry_attributes(mesh, points, {}, {kNan, 0.75F, kInfinity, 0.75F, kNan, kNan, kNan, -kInfinity});
  EXPECT_FLOAT_EQ(mesh.confidence[0], 0.75F);
  EXPECT_EQ(mesh.confidence[1], 0);
}

// Of a grid most vertices have several points as far as the fourth.
TEST(MeshFinish, AttributesDoNotDependOnTheOrderOfThePoints) {
  constexpr std::uint32_t kSide = 6;
  std::vector<Vec3> points;
  Mesh mesh;
  for (std::uint32_t i = 0; i < kSide * kSide * kSide; ++i) {
    const std::uint32_t row = i / kSide;
    const std::uint32_t layer = row / kSide;
    const Vec3 p{static_cast<double>(i % kSide), static_cast<double>(row % kSide), static_cast<double>(layer)};
    points.push_back(p);
    if (i % 5 == 0) points.push_back(p);
    mesh.vertices.push_back(vector::add(p, {0.5, 0.5, 0.5}));
  }
  std::vector<std::array<std::uint8_t, 3>> colors(points.size());
  std::vector<float> confidence(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    colors[i] = {static_cast<std::uint8_t>(37 * i), static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(101 * i)};
    confidence[i] = static_cast<float>(i) / static_cast<float>(points.size());
  }
  Mesh turned = mesh;
  carry_attributes(mesh, points, colors, confidence);
  std::reverse(points.begin(), points.end());
  std::reverse(colors.begin(), colors.end());
  std::reverse(confidence.begin(), confidence.end());
  carry_attributes(turned, points, colors, confidence);
  EXPECT_EQ(turned.colors, mesh.colors);
  EXPECT_EQ(turned.confidence, mesh.confidence);
}

// As scanners mark what did not come back: in a frame with such a point all others are at one place.
TEST(MeshFinish, AttributesDoNotFeelPointsThatAreTooFarAway) {
  TwoSpheres two = two_spheres();
  std::vector<Vec3> points = two.sample.points;
  std::vector<std::array<std::uint8_t, 3>> colors;
  std::vector<float> confidence;
  for (const Vec3& p : points) {
    colors.push_back(p[2] > 0 ? std::array<std::uint8_t, 3>{255, 0, 10} : std::array<std::uint8_t, 3>{0, 255, 10});
    confidence.push_back(p[2] > 0 ? 1.0F : 0.0F);
  }
  carry_attributes(two.mesh, points, colors, confidence);
  for (const double far : {1e18, 3.4e38}) {
    points.push_back({far, far, far});
    colors.push_back({0, 0, 0});
    confidence.push_back(0);
    Mesh mesh = two.mesh;
    carry_attributes(mesh, points, colors, confidence);
    EXPECT_EQ(mesh.colors, two.mesh.colors) << far;
    EXPECT_EQ(mesh.confidence, two.mesh.confidence) << far;
  }
}

TEST(MeshFinish, PointsAtOnePlaceCountOnceWithTheirMean) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}};
  carry_attributes(mesh, points, {{0, 0, 30}, {200, 0, 0}, {90, 0, 30}, {200, 0, 0}, {0, 60, 30}}, {0, 0, 0.5F, 0, 1});
  EXPECT_EQ(mesh.colors[0], (std::array<std::uint8_t, 3>{30, 20, 30}));
  EXPECT_FLOAT_EQ(mesh.confidence[0], 0.5F);
}

// A layer of vertices facing up, over another one facing down, so close that the nearest points are often those of the other.
TEST(MeshFinish, AttributesDoNotGoThroughThinWalls) {
  constexpr std::uint32_t kSide = 12;
  constexpr double kThickness = 0.2;
  std::vector<Vec3> points, normals;
  std::vector<std::array<std::uint8_t, 3>> colors;
  std::vector<float> confidence;
  Mesh mesh;
  for (const bool up : {true, false}) {
    const double z = up ? kThickness : 0, shift = up ? 0 : 0.5;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t k = 0; k < kSide * kSide; ++k) {
      const std::uint32_t i = k % kSide, j = k / kSide;
      points.push_back({i + shift, j + shift, z});
      normals.push_back({0, 0, up ? 2.0 : -2.0});
      colors.push_back(up ? std::array<std::uint8_t, 3>{200, 0, 0} : std::array<std::uint8_t, 3>{0, 0, 200});
      confidence.push_back(up ? 1.0F : 0.5F);
      mesh.vertices.push_back({i + shift + 0.3, j + shift + 0.4, z});
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const std::uint32_t a = first + k, b = a + 1, c = a + kSide, d = c + 1;
      mesh.triangles.push_back(up ? std::array<std::uint32_t, 3>{a, b, d} : std::array<std::uint32_t, 3>{a, d, b});
      mesh.triangles.push_back(up ? std::array<std::uint32_t, 3>{a, d, c} : std::array<std::uint32_t, 3>{a, c, d});
    }
  }
  const auto mixed = [&] {
    return std::count_if(mesh.colors.begin(), mesh.colors.end(), [](const auto& c) { return c[0] != 0 && c[2] != 0; });
  };
  carry_attributes(mesh, points, colors, confidence);
  EXPECT_GT(mixed(), kSide * kSide);
  carry_attributes(mesh, points, colors, confidence, {}, normals);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_EQ(mesh.colors[v], v < mesh.vertices.size() / 2 ? colors.front() : colors.back());
    EXPECT_EQ(mesh.confidence[v], v < mesh.vertices.size() / 2 ? 1.0F : 0.5F);
  }
  // Where all that is near faces away it is taken all the same, as where no normals are known.
  const std::vector<Vec3> down(points.size(), Vec3{0, 0, -1});
  const std::vector<std::array<std::uint8_t, 3>> of_all = [&] {
    carry_attributes(mesh, points, colors, confidence);
    return mesh.colors;
  }();
  carry_attributes(mesh, points, colors, confidence, {}, down);
  EXPECT_TRUE(std::equal(of_all.begin(), of_all.end(), mesh.colors.begin()));
  EXPECT_THROW(carry_attributes(mesh, points, colors, confidence, {}, std::vector<Vec3>{{0, 0, 1}}), InvalidInput);
}

TEST(MeshFinish, SpuriousComponentsAreNotAmongTheLargestThatAreKept) {
  std::vector<mesh::Support> support(4);
  for (std::size_t k = 0; k < support.size(); ++k) {
    mesh::Support& of = support[k];
    of.area = of.near_area = static_cast<double>(support.size() - k);
    of.stands_for = of.stands_for_under_noise = of.points = 1000;
  }
  support[1].strays = 2000;  // more than its points
  MeshOptions options;
  options.keep_largest = 2;
  Dropped dropped;
  EXPECT_EQ(mesh::kept_components(support, options, 0, dropped), (std::vector<std::uint8_t>{1, 0, 1, 0}));
  EXPECT_EQ(dropped.components, 1U);
}

// As the field of an open surface may make them in the air; what only few points hold is kept where there are no strays.
TEST(MeshFinish, ComponentsThatNoPointIsNearAreNotKept) {
  std::vector<mesh::Support> support(3);
  for (std::size_t k = 0; k < support.size(); ++k) {
    mesh::Support& of = support[k];
    of.area = 100;
    of.stands_for = of.stands_for_under_noise = 1000;
    of.near_area = k == 1 ? 0 : 10.0 / static_cast<double>(1 + k);
  }
  Dropped dropped;
  EXPECT_EQ(mesh::kept_components(support, {}, 0, dropped), (std::vector<std::uint8_t>{1, 0, 1}));
  EXPECT_EQ(dropped.components, 1U);
  EXPECT_EQ(dropped.area, 100);
  MeshOptions all;
  all.keep_all = true;
  MeshOptions by_area;
  by_area.min_component = 8;
  for (const MeshOptions& options : {all, by_area}) {
    EXPECT_EQ(mesh::kept_components(support, options, 0, dropped), (std::vector<std::uint8_t>{1, 1, 1}));
  }
}

}  // namespace
