#include <g3r/error.h>
#include <g3r/metrics.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <map>

#include "base/vector.h"
#include "mesh_shapes.h"
#include "metrics/random.h"
#include "metrics/triangle_tree.h"

namespace g3r {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// A few roundings of coordinates of size one.
constexpr double kRoundingOfScores = 1e-13;

// ---- normals

TEST(ScoreNormals, PerfectNormalsOfAnyLengthHaveNoError) {
  const NormalScore score = score_normals({{2, 0, 0}, {0, 1e-200, 0}, {0, 0, 1e200}}, {{1, 0, 0}, {0, 5, 0}, {0, 0, 1}});
  EXPECT_NEAR(score.ae, 0, kRoundingOfScores);
  EXPECT_EQ(score.pco, 1);
  EXPECT_EQ(score.points, 3u);
}

TEST(ScoreNormals, AngleErrorIsHalfOneMinusCosine) {
  // Right, inverted, and two at right angles (which are not on the right side).
  const NormalScore score = score_normals({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}});
  EXPECT_NEAR(score.ae, (0 + 1 + 0.5 + 0.5) / 4, kRoundingOfScores);
  EXPECT_EQ(score.pco, 0.25);
}

TEST(ScoreNormals, ZeroNormalCountsAsWrong) {
  const NormalScore score = score_normals({{0, 0, 0}}, {{1, 0, 0}});
  EXPECT_EQ(score.ae, 0.5);
  EXPECT_EQ(score.pco, 0);
}

// Angles of 0, 4, 8, 172 and 90 degrees: an inverted normal is on the line of the true one.
TEST(ScoreNormals, AnglesInDegrees) {
  std::vector<Vec3> normals;
  for (const double degrees : {0.0, 4.0, 8.0, 172.0}) {
    const double a = degrees * M_PI / 180;
    normals.push_back({3 * std::cos(a), 3 * std::sin(a), 0});
  }
  normals.push_back({0, 0, 0});
  const NormalScore score = score_normals(normals, std::vector<Vec3>(5, Vec3{1, 0, 0}));
  EXPECT_NEAR(score.rmse, std::sqrt((16 + 64 + 172 * 172 + 8100) / 5.0), 1e-9);
  EXPECT_NEAR(score.rmse_unoriented, std::sqrt((16 + 64 + 64 + 8100) / 5.0), 1e-9);
  EXPECT_EQ(score.pgp5, 0.4);
  EXPECT_EQ(score.pgp10, 0.8);
}

TEST(ScoreNormals, BadInputIsRefused) {
  EXPECT_THROW((void)score_normals({}, {}), InvalidInput);
  EXPECT_THROW((void)score_normals({{1, 0, 0}}, {}), InvalidInput);
  EXPECT_THROW((void)score_normals({{1, 0, 0}}, {{0, 0, 0}}), InvalidInput);
  EXPECT_THROW((void)score_normals({{kNan, 0, 0}}, {{1, 0, 0}}), InvalidInput);
}

// ---- random numbers

TEST(Random, SameBitsOnEveryMachine) {
  Random random(1);
  EXPECT_EQ(random.bits(), 0x017daf0019666393u);
  EXPECT_EQ(random.bits(), 0xd9e484272f675712u);
}

TEST(Random, LogarithmAgreesWithTheStandardLibrary) {
  Random random(7);
  for (int i = 0; i < 10000; ++i) {
    const double x = std::ldexp(random.uniform() + 0x1p-53, -(i % 60));
    EXPECT_NEAR(Random::natural_log(x), std::log(x), 4 * 2.2e-16 * std::max(1.0, std::fabs(std::log(x))));
  }
}

TEST(Random, NormalHasTheMomentsOfAGaussian) {
  Random random(3);
  const int n = 200000;
  double m1 = 0, m2 = 0, m4 = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    m1 += x;
    m2 += x * x;
    m4 += x * x * x * x;
  }
  // Five standard deviations of the estimates.
  EXPECT_NEAR(m1 / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(m2 / n, 1, 5 * std::sqrt(2.0 / n));
  EXPECT_NEAR(m4 / n, 3, 5 * std::sqrt(96.0 / n));
}

// ---- sampling

TEST(SampleMesh, PointsLieOnTheirTriangles) {
  const Mesh mesh = shapes::cube();
  const Samples samples = sample_mesh(mesh, 1000, 5);
  ASSERT_EQ(samples.points.size(), 1000u);
  ASSERT_EQ(samples.normals.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec3& p = samples.points[i];
    const Vec3& n = samples.normals[i];
    EXPECT_NEAR(vector::dot(n, n), 1, kRoundingOfScores);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(p[k], 0);
      EXPECT_LE(p[k], 1);
      if (n[k] > 0.5) {
        EXPECT_EQ(p[k], 1);
      }
      if (n[k] < -0.5) {
        EXPECT_EQ(p[k], 0);
      }
    }
  }
}

TEST(SampleMesh, EqualAreasGetEqualShares) {
  // A plate cut finely on one half and not at all on the other.
  Mesh mesh = shapes::united(shapes::moved(shapes::square(1, 0, 1), {-1, 0, 0}), shapes::moved(shapes::square(1, 0, 30), {1, 0, 0}));
  const Samples samples = sample_mesh(mesh, 40000, 2);
  double left = 0;
  Vec3 mean{0, 0, 0};
  for (const Vec3& p : samples.points) {
    left += p[0] < 0 ? 1 : 0;
    mean = vector::add(mean, vector::scale(p, 1.0 / 40000));
  }
  EXPECT_NEAR(left / 40000, 0.5, 5 * 0.5 / 200);  // five standard deviations
  EXPECT_NEAR(mean[0], 0, 5 * std::sqrt(4.0 / 3 / 40000));
  EXPECT_NEAR(mean[1], 0, 5 * std::sqrt(1.0 / 3 / 40000));
}

TEST(SampleMesh, SameSeedSamePointsAndAnotherSeedOthers) {
  const Mesh mesh = shapes::torus(1, 0.3, 20, 10);
  EXPECT_EQ(sample_mesh(mesh, 500, 9).points, sample_mesh(mesh, 500, 9).points);
  EXPECT_NE(sample_mesh(mesh, 500, 9).points, sample_mesh(mesh, 500, 10).points);
}

TEST(SampleMesh, AndScoresCanBeStopped) {
  const Mesh mesh = shapes::cube();
  std::atomic<bool> cancel{true};
  EXPECT_THROW((void)sample_mesh(mesh, 10, 1, 0, {nullptr, &cancel}), Cancelled);
  EXPECT_THROW((void)score_mesh(mesh, mesh, {10}, {nullptr, &cancel}), Cancelled);
  const auto stop = [](std::string_view, double fraction) { return fraction < 0.1; };
  EXPECT_THROW((void)sample_mesh(mesh, 1'000'000, 1, 0, {stop, nullptr}), Cancelled);
}

TEST(SampleMesh, SameBytesOnEveryMachine) {
  const Vec3 p = sample_mesh(shapes::tetrahedron(), 1, 42, 0.5).points[0];
  EXPECT_EQ(p, (Vec3{0.005489992287764117, 0.8336173602989057, -0.2797681489592497}));
}

TEST(SampleMesh, NoiseDisplacesTheSamePointsByItsStandardDeviation) {
  const Mesh mesh = shapes::sphere(1, 40);
  const Samples clean = sample_mesh(mesh, 20000, 4);
  const Samples noisy = sample_mesh(mesh, 20000, 4, 0.05);
  EXPECT_EQ(clean.normals, noisy.normals);
  double sum = 0;
  for (std::size_t i = 0; i < 20000; ++i) {
    const Vec3 d = vector::subtract(noisy.points[i], clean.points[i]);
    sum += vector::dot(d, d);
  }
  EXPECT_NEAR(std::sqrt(sum / 60000), 0.05, 0.05 * 5 / std::sqrt(120000.0));
}

TEST(SampleMesh, TrianglesWithoutAreaGetNoPoints) {
  Mesh mesh = shapes::cube();
  mesh.triangles.insert(mesh.triangles.begin(), {0, 0, 7});
  mesh.triangles.push_back({1, 1, 1});
  for (const Vec3& n : sample_mesh(mesh, 1000, 1).normals) EXPECT_NEAR(vector::dot(n, n), 1, kRoundingOfScores);
}

TEST(SampleMesh, TinyAndHugeMeshesAreSampled) {
  for (const double size : {1e-150, 1e45}) {
    const Samples samples = sample_mesh(shapes::moved(shapes::cube(), {0, 0, 0}, size), 100, 1);
    for (const Vec3& n : samples.normals) EXPECT_NEAR(vector::dot(n, n), 1, kRoundingOfScores);
  }
}

TEST(SampleMesh, BadInputIsRefused) {
  const Mesh cube = shapes::cube();
  EXPECT_THROW((void)sample_mesh({}, 10, 0), InvalidInput);
  EXPECT_THROW((void)sample_mesh(cube, 10, 0, -1), InvalidInput);
  EXPECT_THROW((void)sample_mesh(cube, 10, 0, kNan), InvalidInput);
  Mesh flat = cube;
  flat.triangles = {{0, 0, 1}, {2, 2, 2}};
  EXPECT_THROW((void)sample_mesh(flat, 10, 0), InvalidInput);
  Mesh bad = cube;
  bad.vertices[3][0] = kNan;
  EXPECT_THROW((void)sample_mesh(bad, 10, 0), InvalidInput);
  bad = cube;
  bad.triangles[0][0] = 8;
  EXPECT_THROW((void)sample_mesh(bad, 10, 0), InvalidInput);
  EXPECT_TRUE(sample_mesh(cube, 0, 0).points.empty());
}

// ---- closest points

TEST(TriangleTree, EqualsTestingEveryTriangle) {
  const Mesh mesh = shapes::united(shapes::torus(1, 0.3, 24, 12), shapes::moved(shapes::sphere(0.4, 16), {0.3, -0.2, 0.9}));
  const TriangleTree tree(mesh);
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p{4 * random.uniform() - 2, 4 * random.uniform() - 2, 4 * random.uniform() - 2};
    double expected = HUGE_VAL;
    for (const auto& t : mesh.triangles) {
      expected = std::min(expected, squared_distance_to_triangle(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
    }
    EXPECT_NEAR(tree.closest(p).distance, std::sqrt(expected), kRoundingOfScores);
  }
}

TEST(TriangleTree, DistanceToATriangleByRegion) {
  const Vec3 a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
  EXPECT_NEAR(squared_distance_to_triangle({0.5, 0.5, 3}, a, b, c), 9, kRoundingOfScores);      // face
  EXPECT_NEAR(squared_distance_to_triangle({1, -2, 1}, a, b, c), 5, kRoundingOfScores);         // side ab
  EXPECT_NEAR(squared_distance_to_triangle({2, 2, 0}, a, b, c), 2, kRoundingOfScores);          // side bc
  EXPECT_NEAR(squared_distance_to_triangle({-3, 1, 4}, a, b, c), 25, kRoundingOfScores);        // side ca
  EXPECT_NEAR(squared_distance_to_triangle({-1, -1, 1}, a, b, c), 3, kRoundingOfScores);        // corner a
  EXPECT_NEAR(squared_distance_to_triangle({4, -1, 0}, a, b, c), 5, kRoundingOfScores);         // corner b
  EXPECT_NEAR(squared_distance_to_triangle({-1, 5, 0}, a, b, c), 10, kRoundingOfScores);        // corner c
  EXPECT_NEAR(squared_distance_to_triangle({1, 1, 0}, a, a, a), 2, kRoundingOfScores);          // a point
  EXPECT_NEAR(squared_distance_to_triangle({1, 1, 0}, a, b, {1, 0, 0}), 1, kRoundingOfScores);  // a segment
}

TEST(TriangleTree, KeepsItsDigitsFarAwayAndAtAnyScale) {
  for (const double size : {1e-120, 1e-3, 1e40}) {
    const TriangleTree tree(shapes::moved(shapes::cube(), {0, 0, 0}, size));
    EXPECT_NEAR(tree.closest({0.5 * size, 0.5 * size, 3 * size}).distance / size, 2, kRoundingOfScores);
  }
  const TriangleTree far(shapes::moved(shapes::cube(), {5e6, 4e6, 0}));
  EXPECT_NEAR(far.closest({5e6 + 0.5, 4e6 + 0.5, 1.001}).distance, 0.001, 1e-9);
}

TEST(TriangleTree, TrianglesWithoutAreaAreNeverTheClosest) {
  Mesh mesh = shapes::cube();
  mesh.triangles.insert(mesh.triangles.begin(), {0, 1, 1});
  const TriangleTree tree(mesh);
  EXPECT_NE(tree.closest({0.5, 0, 0}).triangle, 0u);
  mesh.triangles = {{0, 1, 1}};
  EXPECT_THROW(TriangleTree{mesh}, InvalidInput);
}

// ---- meshes

// Spheres of radius 1 and 1.1: every sample is 0.1 from the other, so that nothing is within less and all within more.
TEST(ScoreMesh, FScoresCountWhatIsWithinADistance) {
  const MeshScore score = score_mesh(shapes::sphere(1.1, 200), shapes::sphere(1, 200), {5000, 1, {0.09, 0.11}});
  ASSERT_EQ(score.f_scores.size(), 2U);
  EXPECT_EQ(score.f_scores[0].f, 0);
  EXPECT_EQ(score.f_scores[1].f, 1);
  EXPECT_EQ(score.f_scores[1].distance, 0.11);
}

// One of two spheres far apart: what is there is right, half is missing.
TEST(ScoreMesh, PrecisionIsOfTheMeshAndRecallOfTheTruth) {
  const Mesh one = shapes::sphere(1, 60);
  const FScore score = score_mesh(one, shapes::united(one, shapes::moved(one, {5, 0, 0})), {20000, 1, {0.01}}).f_scores[0];
  EXPECT_EQ(score.precision, 1);
  EXPECT_NEAR(score.recall, 0.5, 5 * 0.5 / std::sqrt(20000.0));  // five standard deviations
  EXPECT_NEAR(score.f, 2 * score.recall / (1 + score.recall), kRoundingOfScores);
}

// Normals that point the other way are consistent still.
TEST(ScoreMesh, NormalConsistencyHasNoSides) {
  const Mesh mesh = shapes::cube();
  EXPECT_NEAR(score_mesh(shapes::inverted(mesh), mesh, {2000, 1}).normal_consistency, 1, 1e-12);
}

TEST(ScoreMesh, NormalConsistencyIsTheMeanCosineOfTheLines) {
  const Mesh level = shapes::square(1, 0, 1);
  Mesh tilted = level;
  for (Vec3& p : tilted.vertices) p = {0.5 * p[0], p[1], std::sqrt(0.75) * p[0]};  // by 60 degrees
  EXPECT_NEAR(score_mesh(tilted, level, {500, 1}).normal_consistency, 0.5, 1e-12);
}

TEST(ScoreMesh, MeshAgainstItselfHasNoError) {
  const Mesh mesh = shapes::torus(1, 0.3, 40, 20);
  const MeshScore score = score_mesh(mesh, mesh, {5000, 1});
  EXPECT_LT(score.chamfer, kRoundingOfScores);
  EXPECT_LT(score.hausdorff, kRoundingOfScores);
  EXPECT_LT(score.ae, kRoundingOfScores);
}

TEST(ScoreMesh, ConcentricSpheresAreTheDifferenceOfRadiiApart) {
  const double facet = 1 - std::cos(shapes::kPi / 100);  // how far the facets of 200 slices lie inside the sphere
  const MeshScore score = score_mesh(shapes::sphere(1.1, 200), shapes::sphere(1, 200), {20000, 1});
  EXPECT_NEAR(score.chamfer, 0.1, 3 * facet);
  EXPECT_NEAR(score.hausdorff, 0.1, 3 * facet);
  EXPECT_LT(score.ae, 1e-3);
}

TEST(ScoreMesh, InvertedMeshHasAngleErrorOne) {
  const Mesh mesh = shapes::sphere(1, 60);
  EXPECT_NEAR(score_mesh(shapes::inverted(mesh), mesh, {5000, 1}).ae, 1, 1e-12);
}

TEST(ScoreMesh, TranslatedPlaneIsAsFarAsTheTranslation) {
  const Mesh low = shapes::square(1, 0, 7);
  const Mesh high = shapes::square(1, 0.25, 3);
  const MeshScore score = score_mesh(low, high, {5000, 1});
  EXPECT_NEAR(score.chamfer, 0.25, kRoundingOfScores);
  EXPECT_NEAR(score.hausdorff, 0.25, kRoundingOfScores);
  EXPECT_NEAR(score.ae, 0, kRoundingOfScores);
}

TEST(ScoreMesh, MissingPartShowsInOneDirectionOnly) {
  // Truth: two spheres 10 apart; mesh: one of them. Half of the true samples are about 8 away or more.
  const Mesh one = shapes::sphere(1, 40);
  const Mesh both = shapes::united(one, shapes::moved(one, {10, 0, 0}));
  const MeshScore score = score_mesh(one, both, {5000, 1});
  EXPECT_GT(score.chamfer, 0.25 * 8);
  EXPECT_LT(score.chamfer, 0.25 * 10);
  EXPECT_NEAR(score.hausdorff, 10, 0.01);
}

TEST(ScoreMesh, BadInputIsRefused) {
  EXPECT_THROW((void)score_mesh(shapes::cube(), shapes::cube(), {0}), InvalidInput);
  EXPECT_THROW((void)score_mesh(shapes::cube(), shapes::cube(), {10, 0, {0.0}}), InvalidInput);
  EXPECT_THROW((void)score_mesh(shapes::cube(), shapes::cube(), {10, 0, {kNan}}), InvalidInput);
  EXPECT_THROW((void)score_mesh({}, shapes::cube()), InvalidInput);
  EXPECT_THROW((void)score_mesh(shapes::cube(), {}), InvalidInput);
}

}  // namespace
}  // namespace g3r
