// What mesh_oriented() says of a mesh: lengths of the points that it was made of, and warnings of what is missing or guessed.
#include <g3r/error.h>
#include <g3r/g3r.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "base/vector.h"
#include "field_shapes.h"

namespace g3r {
namespace {

using testing::OrientedSample;
using testing::sphere_sample;

// The typical distance of n random points of a unit sphere.
double spacing_on_sphere(std::size_t n) { return std::sqrt(4 * M_PI / static_cast<double>(n)); }

OrientedSample joined(OrientedSample one, const OrientedSample& other) {
  one.points.insert(one.points.end(), other.points.begin(), other.points.end());
  one.normals.insert(one.normals.end(), other.normals.begin(), other.normals.end());
  return one;
}

OrientedSample with_sphere(const OrientedSample& sample, std::size_t n, double radius, double x) {
  OrientedSample other = sphere_sample(n, radius, 2);
  for (Vec3& p : other.points) p[0] += x;
  return joined(sample, other);
}

OrientedSample moved_along_normals(OrientedSample sample, double noise) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal(0, noise);
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    sample.points[i] = vector::add(sample.points[i], vector::scale(sample.normals[i], normal(rng)));
  }
  return sample;
}

struct Reported {
  MeshReport report;
  Mesh mesh;

  explicit Reported(const OrientedSample& sample, const MeshOptions& options = {})
      : mesh(mesh_oriented(sample.points, sample.normals, options, {}, &report)) {}

  [[nodiscard]] bool warns(const std::string& words) const {
    const auto& warnings = report.stats.warnings;
    return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& w) { return w.find(words) != std::string::npos; });
  }
};

TEST(MeshReport, PointsOfWhichNoneHasANormalAreRefusedForThat) {
  OrientedSample sample = sphere_sample(200, 1, 1);
  std::fill(sample.normals.begin(), sample.normals.end(), Vec3{0, 0, 0});
  try {
    (void)mesh_oriented(sample.points, sample.normals);
    ADD_FAILURE() << "a mesh of points without normals";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("there are no normals"), std::string::npos) << e.what();
  }
}

// The leaves of the octree are no finer than a sixteenth of the usual ones.
TEST(MeshReport, PointsWithoutSurfaceAreTold) {
  const OrientedSample large = sphere_sample(2000, 1, 1);
  const Reported lost(with_sphere(large, 2000, 0.001, 3)), found(with_sphere(large, 2000, 0.1, 3));
  EXPECT_EQ(lost.report.check.components, 1U);
  EXPECT_TRUE(lost.warns("50 % of the points have no surface near them"));
  EXPECT_TRUE(lost.report.stats.doubtful);
  EXPECT_EQ(found.report.check.components, 2U);
  EXPECT_TRUE(found.report.stats.warnings.empty());
  EXPECT_FALSE(found.report.stats.doubtful);
}

// Random points with random normals, whose surface is what noise leaves; and a sphere with some normals that face inward.
TEST(MeshReport, SurfaceThatFacesAwayFromTheNormalsIsTold) {
  for (const std::size_t n : {50U, 100U, 300U}) {
    std::mt19937_64 rng(n);
    std::uniform_real_distribution<double> uniform(0, 1);
    OrientedSample noise = sphere_sample(n, 1, n);  // for the normals
    for (Vec3& p : noise.points) p = {uniform(rng), uniform(rng), uniform(rng)};
    const Reported random(noise);
    EXPECT_TRUE(random.warns("of the points are on surface that faces away from their normals")) << n;
    EXPECT_TRUE(random.report.stats.doubtful) << n;
  }
  OrientedSample sphere = sphere_sample(2000, 1, 1);
  EXPECT_TRUE(Reported(sphere).report.stats.warnings.empty());
  for (std::size_t i = 0; i < sphere.normals.size(); i += 10) sphere.normals[i] = vector::scale(sphere.normals[i], -1);
  const Reported some(sphere);
  EXPECT_TRUE(some.warns("of the points are on surface that faces away from their normals"));
  EXPECT_FALSE(some.report.stats.doubtful);
  MeshOptions less;
  less.keep_largest = 1;
  EXPECT_TRUE(Reported(sphere, less).report.stats.warnings.empty());
}

// A spiral over the unit sphere about (x, 0, 0), as even as its points can be.
OrientedSample spiral(std::size_t n, double x, double outward) {
  OrientedSample out;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(n), r = std::sqrt(1 - z * z);
    const double angle = M_PI * (1 + std::sqrt(5.0)) * (static_cast<double>(i) + 0.5);
    const Vec3 d{r * std::cos(angle), r * std::sin(angle), z};
    out.points.push_back(vector::add(d, {x, 0, 0}));
    out.normals.push_back(vector::scale(d, outward));
  }
  return out;
}

// Of two spheres, one with normals that face inward, that one is a hollow of a ball whose outside no point is on.
TEST(MeshReport, PartsWithoutPointsAreTold) {
  const Reported opposite(joined(spiral(1000, 0, 1), spiral(1000, 3, -1))), same(joined(spiral(1000, 0, 1), spiral(1000, 3, 1)));
  EXPECT_TRUE(opposite.warns("of the surface is of parts that no point is on"));
  EXPECT_TRUE(opposite.report.stats.doubtful);
  EXPECT_TRUE(same.report.stats.warnings.empty());
}

TEST(MeshReport, FewTrianglesDoNotLookOpen) {
  MeshOptions options;
  options.faces = 20;
  const Reported coarse(sphere_sample(3000, 1, 1), options);
  EXPECT_EQ(coarse.report.check.triangles, 20U);
  EXPECT_TRUE(coarse.report.stats.warnings.empty());
  EXPECT_FALSE(coarse.report.stats.doubtful);
}

// A shell of two spheres, and so few triangles that those of one pierce those of the other.
TEST(MeshReport, TrianglesThatCrossWhenTheyAreFewAreTold) {
  const OrientedSample shell = joined(sphere_sample(6000, 1, 1), sphere_sample(5400, 0.95, 2, -1));
  MeshOptions options;
  options.faces = 8000;
  EXPECT_TRUE(Reported(shell, options).report.stats.warnings.empty());
  options.faces = 200;
  EXPECT_TRUE(Reported(shell, options).warns("more than before simplifying"));
}

// In a frame that a stray makes five million times as large the spacing is below what it resolves.
TEST(MeshReport, StraysDoNotMakeTheScale) {
  OrientedSample sample = sphere_sample(4000, 1, 1);
  MeshOptions options;
  options.noise = {Length::Unit::kSpacing, 0.5};
  const Reported without(sample, options);
  sample.points.push_back({1e7, 0, 0});
  sample.normals.push_back({1, 0, 0});
  const Reported with(sample, options);
  EXPECT_EQ(with.report.check.dropped.points, 1U);
  EXPECT_NEAR(with.report.stats.spacing, without.report.stats.spacing, 1e-6);
  EXPECT_NEAR(with.report.stats.noise, without.report.stats.noise, 1e-6);
  EXPECT_NEAR(with.report.stats.box_side, 2, 0.01);
  EXPECT_NEAR(vector::length(with.report.stats.box_centre), 0, 0.01);
  EXPECT_EQ(with.mesh.vertices.size(), without.mesh.vertices.size());
  EXPECT_TRUE(with.report.stats.warnings.empty());
}

TEST(MeshReport, StraysDoNotMakeTheSpacing) {
  OrientedSample sample = sphere_sample(3000, 1, 1);
  const double spacing = Reported(sample).report.stats.spacing;
  const OrientedSample directions = sphere_sample(300, 1, 3);
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (const Vec3& n : directions.normals) {
    sample.points.push_back({uniform(rng), uniform(rng), uniform(rng)});
    sample.normals.push_back(n);
  }
  const Reported with(sample);
  EXPECT_GT(with.report.check.dropped.points, 250U);
  EXPECT_NEAR(with.report.stats.spacing, spacing, 0.005 * spacing);
}

// Copies of outliers are neither more of them nor more beside the parts of the mesh.
TEST(MeshReport, CopiesOfOutliersAreOne) {
  std::vector<Vec3> points = sphere_sample(1000, 1, 1).points;
  const std::vector<Vec3> few = sphere_sample(20, 0.12, 2).points;
  for (const Vec3& p : few) points.push_back(vector::add(p, {1.6, 0, 0}));
  const auto outliers = static_cast<std::ptrdiff_t>(points.size());
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> uniform(-2, 2);
  for (int i = 0; i < 200; ++i) points.push_back({uniform(rng), uniform(rng), uniform(rng)});
  const Reconstruction once = reconstruct(points);
  const std::vector<Vec3> added(points.begin() + outliers, points.end());
  points.insert(points.end(), added.begin(), added.end());
  const Reconstruction twice = reconstruct(points);
  EXPECT_GT(once.check.dropped.points, 100U);
  EXPECT_EQ(twice.check.dropped.points, once.check.dropped.points);
  EXPECT_EQ(twice.mesh.vertices, once.mesh.vertices);
}

TEST(MeshReport, HasTheNoiseThatIsSmoothedOver) {
  const OrientedSample clean = sphere_sample(5000, 1, 1);
  EXPECT_EQ(Reported(clean).report.stats.noise, 0);
  const double noise = 0.5 * spacing_on_sphere(clean.points.size());
  EXPECT_NEAR(Reported(moved_along_normals(clean, noise)).report.stats.noise, noise, 0.2 * noise);
}

TEST(MeshReport, TrimmingThatCutsNothingOrTooMuchIsTold) {
  const OrientedSample sphere = sphere_sample(3000, 1, 1);
  MeshOptions options;
  options.trim = MeshOptions::Trim::kAuto;
  const Reported closed(sphere, options);
  EXPECT_TRUE(closed.warns("nothing was trimmed: no surface is farther than 4 spacings"));
  EXPECT_FALSE(closed.report.stats.doubtful);
  OrientedSample half;
  for (std::size_t i = 0; i < sphere.points.size(); ++i) {
    if (sphere.points[i][2] < 0) continue;
    half.points.push_back(sphere.points[i]);
    half.normals.push_back(sphere.normals[i]);
  }
  EXPECT_TRUE(Reported(half, options).report.stats.warnings.empty());
  // Of an open part that is dropped after it was trimmed nothing is left; a closed one is dropped for its size alone.
  options.keep_largest = 1;
  OrientedSample small;
  for (const Vec3& p : half.points) small.points.push_back({0.5 * p[0] + 5, 0.5 * p[1], 0.5 * p[2]});
  small.normals = half.normals;
  const Reported one(joined(sphere, small), options);
  EXPECT_TRUE(one.report.check.closed);
  EXPECT_FALSE(one.warns("nothing was"));
  EXPECT_TRUE(Reported(with_sphere(sphere, 1000, 0.5, 5), options).warns("nothing was trimmed"));
  options.keep_largest = 0;
  options.trim = MeshOptions::Trim::kDistance;
  for (const double spacings : {0.7, 4.0}) {
    options.trim_distance = spacings * spacing_on_sphere(sphere.points.size());
    EXPECT_EQ(Reported(half, options).warns("less than the gaps between the points"), spacings < 1);
  }
}

// One of two parts that no frame holds together has a mesh, and the other one a warning; three have none that is fine enough.
TEST(MeshReport, PartsThatAreTooFarApartAreNamedAsSuch) {
  OrientedSample apart = with_sphere(sphere_sample(300, 1, 1), 300, 1, 1e7);
  const Reported two(apart, {});
  EXPECT_TRUE(two.warns("300 points are too far from the others"));
  EXPECT_TRUE(two.report.stats.doubtful);
  EXPECT_EQ(two.report.stats.outliers, 300U);
  const Reported three(with_sphere(apart, 300, 1, 2e7), {});
  EXPECT_TRUE(three.warns("800,000 spacings wide"));
}

}  // namespace
}  // namespace g3r
