// orient() as a user sees it: right sides on every topology, the same result for every order, place, scale and thread count, clear errors.
#include <g3r/g3r.h>

#include "base/vector.h"
#include "sanitized.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

namespace g3r {
namespace {

using shapes::Surface;

Surface interlocked_tori(std::size_t n) {
  Surface a = shapes::torus(n, 0.5, 0.15, 3, {-0.25, 0, 0});
  Surface b = shapes::torus(n, 0.5, 0.15, 4);
  for (auto* v : {&b.points, &b.normals}) {
    for (Vec3& p : *v) p = {p[0], -p[2], p[1]};
  }
  for (Vec3& p : b.points) p[0] += 0.25;
  return shapes::join(a, b);
}

void expect_oriented(const char* name, const Surface& s, const Options& options, double share, double error) {
  const Orientation o = orient(s.points, options);
  ASSERT_EQ(o.normals.size(), s.points.size());
  EXPECT_GE(shapes::share_correct(o.normals, s.normals), share) << name;
  EXPECT_LE(shapes::angle_error(o.normals, s.normals), error) << name;
  for (const Vec3& n : o.normals) EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-9);
  double area = 0;
  double true_area = 0;
  for (const double a : o.areas) area += a;
  for (const double a : s.areas) true_area += a;
  EXPECT_NEAR(area / true_area, 1, 0.25) << name;
}

TEST(Orient, FindsTheOutsideOfEveryTopology) {
  for (const Method method : {Method::kEnergy, Method::kGreen}) {
    Options options;
    options.method = method;
    expect_oriented("sphere", shapes::sphere(3000), options, 1, 0.002);
    expect_oriented("torus", shapes::torus(4000, 0.6, 0.25, 9), options, 1, 0.005);
    expect_oriented("nested", shapes::join(shapes::sphere(4000, 0.9), shapes::sphere(1500, 0.5), true), options, 1, 0.005);
    expect_oriented("two components", shapes::join(shapes::sphere(2000, 0.4, {-0.5, 0, 0}), shapes::sphere(2000, 0.4, {0.5, 0.1, 0})),
                    options, 1, 0.005);
    expect_oriented("interlocked", interlocked_tori(3000), options, 1, 0.01);
  }
}

// An eighth of the spacing squared, an eighth of the angle.
TEST(Orient, AnglesFallInProportionToThePoints) {
  const auto angle = [](std::size_t n) {
    const Surface s = shapes::ellipsoid(n, 0.9, 0.6, 0.45);
    return std::sqrt(shapes::angle_error(orient(s.points).normals, s.normals));
  };
  EXPECT_LT(angle(16000), angle(2000) / 4);
}

TEST(Orient, PaperPresetOrientsCleanShapes) {
  Options options;
  options.preset = Preset::kPaper;
  const Surface sphere = shapes::sphere(400);
  const Orientation dense = orient(sphere.points, options);
  EXPECT_EQ(dense.stats.solver, "dense");
  EXPECT_GE(shapes::share_correct(dense.normals, sphere.normals), 0.99);
  const Surface torus = shapes::torus(3000);
  const Orientation iterative = orient(torus.points, options);
  EXPECT_EQ(iterative.stats.iterations.size(), 80U);
  EXPECT_EQ(iterative.stats.iterations[19].kind, "sd");
  EXPECT_EQ(iterative.stats.iterations[20].kind, "cg");
  EXPECT_GE(shapes::share_correct(iterative.normals, torus.normals), 0.97);
}

TEST(Orient, ResidualsOfConjugateGradientsFall) {
  Options options;
  options.tolerance = 2e-3;
  options.schedule = "100 cg";
  const Orientation o = orient(shapes::torus(3000, 0.6, 0.25, 2).points, options);
  EXPECT_TRUE(o.stats.converged);
  EXPECT_LE(o.stats.iterations.back().residual, 2e-3);
  for (std::size_t k = 10; k < o.stats.iterations.size(); ++k) {  // not every step: what falls in each is the energy
    EXPECT_LT(o.stats.iterations[k].residual, o.stats.iterations[k - 10].residual) << k;
  }
}

// From 40,000 points on a solution on a quarter of them is the start.
TEST(Orient, CoarseStartsSaveSteps) {
  if (kSanitized) GTEST_SKIP() << "long";
  const Surface s = shapes::join(shapes::sphere(30000, 0.9), shapes::torus(10000, 0.4, 0.15, 4), true);
  Options options;
  const Orientation coarse = orient(s.points, options);
  options.schedule = "45 cg";
  const Orientation direct = orient(s.points, options);
  EXPECT_TRUE(coarse.stats.converged);
  EXPECT_LT(2 * coarse.stats.iterations.size(), direct.stats.iterations.size());
  EXPECT_LE(coarse.stats.iterations.back().residual, coarse.stats.tolerance);
  EXPECT_GT(coarse.stats.tolerance, direct.stats.tolerance);
  EXPECT_EQ(shapes::share_correct(coarse.normals, s.normals), 1);
  EXPECT_LE(shapes::angle_error(coarse.normals, s.normals), 1.1 * shapes::angle_error(direct.normals, s.normals));
  options.schedule.clear();
  options.threads = 3;
  EXPECT_EQ(orient(s.points, options).normals, coarse.normals);
}

// W eta = 1/2 is not true of open surfaces: steps that make it so turn their normals.
TEST(Orient, CoarseStartsSpareOpenSurfaces) {
  if (kSanitized) GTEST_SKIP() << "long";
  const Surface sphere = shapes::sphere(90000);
  Surface half;
  for (std::size_t i = 0; i < sphere.points.size(); ++i) {
    if (sphere.points[i][2] < 0) continue;
    half.points.push_back(sphere.points[i]);
    half.normals.push_back(sphere.normals[i]);
  }
  ASSERT_GT(half.points.size(), 40000U);
  const Orientation o = orient(half.points);
  EXPECT_GE(shapes::share_correct(o.normals, half.normals), 0.999);
  EXPECT_LE(shapes::angle_error(o.normals, half.normals), 0.01);
}

TEST(Orient, IsTheSameForEveryOrderOfThePoints) {
  const Surface s = shapes::torus(3000, 0.6, 0.25, 8);
  std::vector<Vec3> shuffled = s.points;
  std::vector<std::size_t> from(shuffled.size());
  shapes::Random random(2);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = i;
  for (std::size_t i = from.size(); i-- > 1;) std::swap(from[i], from[random.bits() % (i + 1)]);
  for (std::size_t i = 0; i < from.size(); ++i) shuffled[i] = s.points[from[i]];
  const Orientation a = orient(s.points);
  const Orientation b = orient(shuffled);
  for (std::size_t i = 0; i < from.size(); ++i) {
    ASSERT_EQ(a.normals[from[i]], b.normals[i]);
    ASSERT_EQ(a.areas[from[i]], b.areas[i]);
    ASSERT_EQ(a.confidence[from[i]], b.confidence[i]);
  }
}

TEST(Orient, IsTheSameForEveryNumberOfThreads) {
  const Surface s = shapes::torus(kSanitized ? 2500 : 6000, 0.6, 0.25, 8);
  Options options;
  options.threads = 1;
  const Orientation one = orient(s.points, options);
  for (const int threads : {2, 3, 8}) {
    options.threads = threads;
    const Orientation many = orient(s.points, options);
    EXPECT_EQ(one.normals, many.normals) << threads;
    EXPECT_EQ(one.areas, many.areas) << threads;
    EXPECT_EQ(one.confidence, many.confidence) << threads;
  }
}

double largest_angle(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3 d{a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]};
    largest = std::max(largest, 2 * std::asin(std::min(1.0, std::hypot(d[0], d[1], d[2]) / 2)) * 180 / std::numbers::pi);
  }
  return largest;
}

TEST(Orient, DoesNotDependOnPlaceOrScale) {
  const Surface s = shapes::torus(4000, 0.6, 0.25, 6);
  std::vector<Vec3> base = s.points;
  for (Vec3& p : base) {  // quantised to what double holds at UTM size, so that both clouds are the same shape exactly
    for (double& c : p) c = std::round(c * 0x1p24) * 0x1p-24;
  }
  const Orientation origin = orient(base);
  std::vector<Vec3> utm = base;
  for (Vec3& p : utm) {
    p[0] += 500000;
    p[1] += 5000000;
    p[2] += 1000;
  }
  EXPECT_LE(largest_angle(orient(utm).normals, origin.normals), 1e-3);
  for (const double scale : {0x1p-100, 0x1p20, 1e-30, 1e30, 1e6}) {
    std::vector<Vec3> scaled = base;
    for (Vec3& p : scaled) {
      for (double& c : p) c *= scale;
    }
    const Orientation o = orient(scaled);
    // Scales that are no powers of two round: two boxes at the edge of the opening rule may be summed either way.
    EXPECT_LE(largest_angle(o.normals, origin.normals), 2e-2) << scale;
    EXPECT_NEAR(o.areas[7] / (origin.areas[7] * scale * scale), 1, 1e-3);
  }
}

// A rotation by a unit quaternion (w, x, y, z).
Vec3 rotated(const std::array<double, 4>& q, const Vec3& p) {
  const auto [w, x, y, z] = q;
  return {(1 - 2 * (y * y + z * z)) * p[0] + 2 * (x * y - w * z) * p[1] + 2 * (x * z + w * y) * p[2],
          2 * (x * y + w * z) * p[0] + (1 - 2 * (x * x + z * z)) * p[1] + 2 * (y * z - w * x) * p[2],
          2 * (x * z - w * y) * p[0] + 2 * (y * z + w * x) * p[1] + (1 - 2 * (x * x + y * y)) * p[2]};
}

// And with its mirror image: sides are the same, and directions but for the order of the points and the boxes that they are summed in.
TEST(Orient, MovesWithTheCloud) {
  const Surface s = shapes::join(shapes::torus(1400, 0.6, 0.25, 6), shapes::sphere(300, 0.2));
  const std::vector<Vec3> still = orient(s.points).normals;
  shapes::Random random(11);
  const int motions = kSanitized ? 3 : 10;
  for (int m = 0; m < motions; ++m) {
    std::array<double, 4> q{};
    double size = 0;
    do {  // uniform in the ball: its direction is a uniform rotation
      for (double& c : q) c = random.uniform(-1, 1);
      size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    } while (size > 1 || size < 0.1);
    for (double& c : q) c /= size;
    const double scale = std::pow(10.0, random.uniform(-6, 6));
    const Vec3 shift{random.uniform() * scale, random.uniform() * scale, random.uniform() * scale};
    const auto turned = [&](const Vec3& v) { return rotated(q, {v[0], v[1], m % 2 == 0 ? v[2] : -v[2]}); };
    Surface moved;
    for (const Vec3& p : s.points) moved.points.push_back(vector::add(vector::scale(turned(p), scale), shift));
    for (const Vec3& n : s.normals) moved.normals.push_back(turned(n));
    const std::vector<Vec3> normals = orient(moved.points).normals;
    EXPECT_EQ(shapes::share_correct(normals, moved.normals), 1) << m;
    std::vector<double> angles;
    for (std::size_t i = 0; i < normals.size(); ++i) angles.push_back(std::acos(std::min(1.0, vector::dot(normals[i], turned(still[i])))));
    std::sort(angles.begin(), angles.end());
    EXPECT_LT(angles[angles.size() / 2], 1e-3) << m;
    EXPECT_LT(angles[angles.size() * 99 / 100], 0.03) << m;
    EXPECT_LT(angles.back(), 0.2) << m;
  }
}

TEST(Orient, DuplicatesShareANormalAndTheirArea) {
  Surface s = shapes::sphere(1000);
  const std::vector<Vec3> once = s.points;
  const Orientation single = orient(once);
  s.points.insert(s.points.end(), once.begin(), once.begin() + 300);
  const Orientation o = orient(s.points);
  EXPECT_EQ(o.stats.merged_duplicates, 300U);
  EXPECT_EQ(o.stats.used, 1000U);
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_EQ(o.normals[i], o.normals[1000 + i]);
    EXPECT_EQ(o.normals[i], single.normals[i]);
    EXPECT_DOUBLE_EQ(o.areas[i] + o.areas[1000 + i], single.areas[i]);
  }
}

TEST(Orient, NonFinitePointsAreLeftOutAndReported) {
  Surface s = shapes::sphere(1000);
  s.points[5][1] = std::numeric_limits<double>::quiet_NaN();
  s.points[6][2] = std::numeric_limits<double>::infinity();
  const Orientation o = orient(s.points);
  EXPECT_EQ(o.stats.dropped_non_finite, 2U);
  EXPECT_EQ(o.normals[5], (Vec3{0, 0, 0}));
  EXPECT_EQ(o.confidence[6], 0.0F);
  EXPECT_FALSE(o.stats.warnings.empty());
}

TEST(Orient, FloatAndStridedInputGiveTheSameAsDoubles) {
  const Surface s = shapes::sphere(800);
  std::vector<float> strided;
  std::vector<Vec3> rounded;
  for (const Vec3& p : s.points) {
    for (const double c : p) strided.push_back(static_cast<float>(c));
    strided.push_back(-7);
    rounded.push_back({static_cast<double>(static_cast<float>(p[0])), static_cast<double>(static_cast<float>(p[1])),
                       static_cast<double>(static_cast<float>(p[2]))});
  }
  const Orientation a = orient(PointsView(strided.data(), s.points.size(), Scalar::kFloat32, 16));
  EXPECT_EQ(a.normals, orient(rounded).normals);
}

TEST(Orient, ErrorsSayWhatIsWrong) {
  const auto message = [](const std::vector<Vec3>& points, const Options& options) -> std::string {
    try {
      static_cast<void>(orient(points, options));
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message({}, {}).find("too few points"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 0}}, {}).find("too few points: 3"), std::string::npos);
  EXPECT_NE(message(std::vector<Vec3>(50, Vec3{1, 2, 3}), {}).find("same place"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}}, {}).find("distinct"), std::string::npos);
  EXPECT_NE(message({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 5}}, {}).find("on one line"), std::string::npos);
  const std::vector<Vec3> good = shapes::sphere(100).points;
  Options options;
  options.degree = 9;
  EXPECT_NE(message(good, options).find("degree"), std::string::npos);
  options = {};
  options.epsilon = {Length::Unit::kInput, -1};
  EXPECT_NE(message(good, options).find("epsilon"), std::string::npos);
  options = {};
  options.noise = {Length::Unit::kSpacing, -0.5};
  EXPECT_NE(message(good, options).find("noise"), std::string::npos);
  options.noise.value = 0.5;
  options.preset = Preset::kPaper;
  EXPECT_NE(message(good, options).find("noise"), std::string::npos);
  options = {};
  options.schedule = "ten cg";
  EXPECT_NE(message(good, options).find("schedule"), std::string::npos);
  options = {};
  options.accuracy = 3;
  EXPECT_NE(message(good, options).find("accuracy"), std::string::npos);
  options = {};
  options.solver = Solver::kDense;
  options.degree = 2;
  EXPECT_NE(message(shapes::sphere(4100).points, options).find("dense"), std::string::npos);
  options = {};
  options.max_memory = 1000;
  EXPECT_THROW(static_cast<void>(orient(good, options)), Unavailable);
}

TEST(Noise, TheGivenOneStandsForTheEstimate) {
  Surface sphere = shapes::sphere(3000, 1);
  shapes::scatter(sphere, 0.03);
  const Orientation automatic = orient(sphere.points);
  ASSERT_GT(automatic.stats.noise, 0);
  Options options;
  options.noise = {Length::Unit::kInput, automatic.stats.noise};
  EXPECT_LT(shapes::angle_error(orient(sphere.points, options).normals, automatic.normals), 1e-6);
  options.noise = {Length::Unit::kSpacing, 0.2};
  EXPECT_NEAR(orient(sphere.points, options).stats.noise, 0.2 * automatic.stats.spacing, 1e-12);
  options.noise = {Length::Unit::kPercent, 1};
  EXPECT_NEAR(orient(sphere.points, options).stats.noise, 0.01 * std::sqrt(12.0), 2e-3);
  options.noise = {Length::Unit::kSpacing, 0};
  const Orientation clean = orient(sphere.points, options);
  EXPECT_EQ(clean.stats.noise, 0);
  EXPECT_GT(shapes::angle_error(clean.normals, sphere.normals), 1.2 * shapes::angle_error(automatic.normals, sphere.normals));
}

// Mean distance of the vertices from the unit sphere.
double roughness(const Mesh& mesh) {
  double sum = 0;
  for (const Vec3& v : mesh.vertices) sum += std::abs(std::hypot(v[0], v[1], v[2]) - 1);
  return sum / static_cast<double>(mesh.vertices.size());
}

// Clean points stay where they are, noisy ones are moved onto the surface that they scatter about.
TEST(Noise, TheGivenOneReachesTheMesher) {
  Surface sphere = shapes::sphere(3000, 1);
  shapes::scatter(sphere, 0.03);
  MeshOptions mesh;
  const double estimated = roughness(mesh_oriented(sphere.points, sphere.normals));
  mesh.noise = {Length::Unit::kInput, 0.03};
  EXPECT_NEAR(roughness(mesh_oriented(sphere.points, sphere.normals, mesh)), estimated, 0.1 * estimated);
  mesh.noise.value = 0;
  EXPECT_GT(roughness(mesh_oriented(sphere.points, sphere.normals, mesh)), 2 * estimated);
  mesh.noise.value = -1;
  EXPECT_THROW((void)mesh_oriented(sphere.points, sphere.normals, mesh), InvalidInput);
  Options options;
  options.noise = {Length::Unit::kSpacing, 0};
  const Reconstruction clean = reconstruct(sphere.points, options);
  mesh.noise = options.noise;
  const double same = roughness(mesh_oriented(sphere.points, clean.orientation.normals, mesh));
  EXPECT_NEAR(roughness(clean.mesh), same, 0.01 * same);  // with its own estimate a quarter more
}

// However large: what comes out are unit vectors.
TEST(Noise, AnySizeIsTaken) {
  const Surface sphere = shapes::sphere(2000);
  for (const double spacings : {1e-12, 3.0, 1e3, 1e9}) {
    Options options;
    options.noise = {Length::Unit::kSpacing, spacings};
    for (const Vec3& n : orient(sphere.points, options).normals) ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-9) << spacings;
  }
}

// The wall of a cavity, a dozen standard deviations from all else, under noise of more than a spacing.
TEST(Noise, CavitiesKeepTheirSides) {
  for (const double sigma : {1.2, 1.4, 1.6}) {
    Surface shells = shapes::join(shapes::sphere(16000, 0.8), shapes::sphere(4000, 0.4), true);
    shapes::scatter(shells, sigma * 0.0225);  // of the spacing
    const Orientation o = orient(shells.points);
    EXPECT_GT(shapes::share_correct(o.normals, shells.normals), 0.999) << sigma;
    EXPECT_LT(o.stats.confidence_below_half, 0.05) << sigma;
  }
}

TEST(Plan, HasTheMeshInIt) {
  const std::vector<Vec3> points = shapes::torus(20000, 0.6, 0.25, 1).points;
  const std::size_t orient_only = plan(points).planned_memory_bytes;
  MeshOptions mesh;
  const std::size_t automatic = plan(points, {}, mesh).planned_memory_bytes;
  EXPECT_GT(automatic, orient_only);
  mesh.depth = 10;
  EXPECT_GT(plan(points, {}, mesh).planned_memory_bytes, 4 * automatic);
}

TEST(Plan, ThePaperPresetGivesTheFieldMesherNoDepth) {
  const std::vector<Vec3> points = shapes::sphere(9).points;
  Options paper;
  paper.preset = Preset::kPaper;
  MeshOptions field;
  field.mesher = Mesher::kField;
  EXPECT_EQ(plan(points, paper, field).depth, 0);
  EXPECT_LT(plan(points, paper, field).planned_memory_bytes, std::size_t{64} << 20);
}

TEST(Orient, StopsWhenAsked) {
  const std::vector<Vec3> points = shapes::torus(20000, 0.6, 0.25, 1).points;
  Monitor monitor;
  int calls = 0;
  monitor.progress = [&](std::string_view, double) { return ++calls < 5; };
  EXPECT_THROW(static_cast<void>(orient(points, {}, monitor)), Cancelled);
  EXPECT_EQ(calls, 5);
  const std::atomic<bool> stop{true};
  Monitor stopped;
  stopped.cancel = &stop;
  EXPECT_THROW(static_cast<void>(orient(points, {}, stopped)), Cancelled);
}

// A plan of a great cloud takes seconds.
TEST(Reconstruct, StopsBeforeItsPlan) {
  const std::atomic<bool> stop{true};
  Monitor stopped;
  stopped.cancel = &stop;
  Options options;
  options.max_memory = 1;
  EXPECT_THROW(static_cast<void>(reconstruct(shapes::torus(2000, 0.6, 0.25, 1).points, options, {}, stopped)), Cancelled);
}

// Clumps far smaller than the least epsilon: the rows of their points are the same to rounding.
TEST(Orient, ThePaperSolvesForClumpsByConjugateGradients) {
  shapes::Random random(3);
  Surface clumps;
  for (const Vec3& centre : shapes::sphere(40).points) {
    for (int k = 0; k < 10; ++k) {
      clumps.points.push_back(
          {centre[0] + random.uniform(0, 1e-11), centre[1] + random.uniform(0, 1e-11), centre[2] + random.uniform(0, 1e-11)});
    }
  }
  Options options;
  options.preset = Preset::kPaper;
  const Orientation o = orient(clumps.points, options);
  EXPECT_EQ(o.stats.solver, "cg");
  EXPECT_FALSE(o.stats.iterations.empty());
  options.solver = Solver::kDense;
  try {
    (void)orient(clumps.points, options);
    ADD_FAILURE();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("too close together"), std::string::npos);
  }
}

// Distances that no float, and whose squares no double, can hold.
TEST(Orient, PointsOfEveryMagnitudeGiveNumbers) {
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) {
    const double size = std::pow(10.0, 5 * (i % 20) - 80) * (i % 7 - 3);
    points.push_back({size, i < 20 ? size * size * 1e-60 : i % 3, i < 40 ? 0 : -size});
  }
  const Orientation o = orient(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(std::isfinite(o.areas[i]) && o.areas[i] >= 0) << i;
    EXPECT_NEAR(std::hypot(o.normals[i][0], o.normals[i][1], o.normals[i][2]), 1, 1e-6) << i;
  }
}

TEST(Orient, ScalesOutOfReachAreSaid) {
  const std::vector<Vec3> sphere = shapes::sphere(1000).points;
  const auto row = [&](int count, double apart) {
    std::vector<Vec3> points;
    for (int k = 0; k < count; ++k) {
      for (const Vec3& p : sphere) points.push_back({p[0] + k * apart, p[1], p[2] - k * apart});
    }
    return points;
  };
  const auto text = [](const std::vector<std::string>& warnings) {
    return std::accumulate(warnings.begin(), warnings.end(), std::string());
  };
  EXPECT_EQ(text(reconstruct(row(2, 1e4)).orientation.stats.warnings), "");
  const Orientation one = orient(row(2, 1e6));
  EXPECT_NE(text(one.stats.warnings).find("1000 points are too far from the others"), std::string::npos);
  EXPECT_EQ(one.stats.outliers, 1000U);
  EXPECT_NE(text(orient(row(3, 1e7)).stats.warnings).find("a millionth of the cloud's width"), std::string::npos);
}

TEST(Orient, SmallestCloudsWork) {
  const std::vector<Vec3> tetrahedron{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const Orientation o = orient(tetrahedron);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3& n = o.normals[i];
    const Vec3& p = tetrahedron[i];
    EXPECT_GT(n[0] * p[0] + n[1] * p[1] + n[2] * p[2], 0);
  }
}

// More steps with the width and the weight of the solve before left 3 % of the sides wrong here.
TEST(Orient, PlatesAreRightFromACoarseStart) {
  const Surface plates = shapes::plates(9, 1, 1.8, 2.7, 0.02);
  ASSERT_GT(plates.points.size(), 40000U);
  EXPECT_GE(shapes::share_correct(orient(plates.points).normals, plates.normals), 0.998);
}

// Noisy points on the wrong side must have lower confidence: area under the ROC curve.
TEST(Confidence, RanksWrongSidesOnNoisyData) {
  shapes::Random random(4);
  Surface s = shapes::join(shapes::torus(6000, 0.6, 0.12, 6), shapes::ellipsoid(4000, 0.4, 0.4, 0.05, {0, 0, 0}));
  for (Vec3& p : s.points) {
    for (double& c : p) c += 0.01 * random.gaussian();  // 0.5 % of the diagonal
  }
  const Orientation o = orient(s.points);
  std::vector<std::pair<float, bool>> ranked;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const double cosine = o.normals[i][0] * s.normals[i][0] + o.normals[i][1] * s.normals[i][1] + o.normals[i][2] * s.normals[i][2];
    ranked.emplace_back(o.confidence[i], cosine > 0);
  }
  std::sort(ranked.begin(), ranked.end());
  double wrong = 0;
  double right = 0;
  double area = 0;
  for (const auto& [confidence, good] : ranked) {
    if (good) {
      area += wrong;
      ++right;
    } else {
      ++wrong;
    }
  }
  ASSERT_GT(wrong, 50);
  EXPECT_GT(area / (wrong * right), 0.85) << wrong << " of " << wrong + right << " wrong";
}

// Normals are told at any scale; a mesh is refused before the work where its area and volume could not be.
TEST(Reconstruct, RefusesWhatCannotBeMeasured) {
  const Surface s = shapes::sphere(500, 1);
  for (const double scale : {1e60, 1e-71, 1e-150}) {
    std::vector<Vec3> points = s.points;
    for (Vec3& p : points) p = vector::scale(p, scale);
    EXPECT_THROW((void)reconstruct(points), InvalidInput);
    EXPECT_THROW((void)mesh_oriented(points, s.normals), InvalidInput);
    EXPECT_EQ(shapes::share_correct(orient(points).normals, s.normals), 1);
  }
}

// Copies of a point whose normals cancel are like one without a normal: no direction is made up for them. So is a place that no frame holds
// together with the others.
TEST(MeshOriented, LeavesOutWhatHasNoDirectionOrNoPlace) {
  const Surface s = shapes::sphere(2000, 1);
  std::vector<Vec3> points = s.points, normals = s.normals, directed, directions;
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (i % 20 == 0) {
      points.push_back(s.points[i]);
      normals.push_back(vector::scale(s.normals[i], -1));
    } else {
      directed.push_back(s.points[i]);
      directions.push_back(s.normals[i]);
    }
  }
  points.push_back({1e30, 2e29, 0});
  normals.push_back({0, 0, 1});
  MeshReport report;
  const Mesh mesh = mesh_oriented(points, normals, {}, {}, &report), expected = mesh_oriented(directed, directions);
  EXPECT_EQ(mesh.vertices, expected.vertices);
  EXPECT_EQ(mesh.triangles, expected.triangles);
  EXPECT_EQ(report.stats.points, 2101U);
  EXPECT_EQ(report.stats.used, 1900U);
  EXPECT_EQ(report.stats.outliers, 1U);
  EXPECT_EQ(report.check.dropped.points, 1U);
  EXPECT_EQ(report.stats.merged_duplicates, 0U);
  ASSERT_FALSE(report.stats.warnings.empty());
  EXPECT_NE(report.stats.warnings.front().find("200 points at places where normals are opposite"), std::string::npos);
}

// Also where points are there five times, with a normal of its own each.
TEST(MeshOriented, DoesNotDependOnTheOrderOfCopies) {
  const Surface s = shapes::sphere(1000, 1);
  shapes::Random random(9);
  std::vector<Vec3> points, normals;
  for (std::size_t copy = 0; copy < 5; ++copy) {
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      points.push_back(s.points[i]);
      normals.push_back(
          vector::normalised(vector::add(s.normals[i], vector::scale({random.normal(), random.normal(), random.normal()}, 0.1))));
    }
  }
  const Mesh mesh = mesh_oriented(points, normals);
  std::reverse(points.begin(), points.end());
  std::reverse(normals.begin(), normals.end());
  EXPECT_EQ(mesh_oriented(points, normals).vertices, mesh.vertices);
}

// After a coarse start random points leave a residual that the normals do not show.
TEST(Orient, ASphereOfManyRandomPointsConverges) {
  shapes::Random random(3);
  std::vector<Vec3> points(40000);
  for (Vec3& p : points) {
    for (double& c : p) c = random.gaussian();
    p = vector::scale(p, 1 / std::sqrt(vector::dot(p, p)));
  }
  const Orientation o = orient(points);
  EXPECT_TRUE(o.stats.converged);
  EXPECT_LT(shapes::angle_error(o.normals, points), 1e-3);
}

// Vectors of single points follow the noise: from them a third of these points is unsure.
// Two walls closer together than the noise: half of the sides are wrong, and nothing shows which.
TEST(Confidence, PromisesNothingWhereNoiseHidesTheWalls) {
  const double spacing = 0.02;
  Surface plate = shapes::join(shapes::plates(1, 1, 1, 1, spacing), shapes::sphere(9000, 0.4, {0, 0, 1}));
  shapes::scatter(plate, 1.2 * spacing);
  const Orientation o = orient(plate.points);
  std::size_t sure_and_wrong = 0;
  for (std::size_t i = 0; i < plate.points.size(); ++i) {
    const Vec3& n = plate.normals[i];
    const double cosine = o.normals[i][0] * n[0] + o.normals[i][1] * n[1] + o.normals[i][2] * n[2];
    if (cosine < 0 && o.confidence[i] > 0.9F) ++sure_and_wrong;
  }
  EXPECT_LE(sure_and_wrong, plate.points.size() * 3 / 1000);
  EXPECT_LT(shapes::share_correct(o.normals, plate.normals), 0.95);  // there is something to be unsure of
  EXPECT_FALSE(o.stats.consistent);
}

// Right sides are promised, not only ranked: what no wall is near to is sure under noise too.
TEST(Confidence, IsSureOfASphereUnderNoise) {
  shapes::Random random(6);
  Surface s = shapes::sphere(8000, 1);
  const double spacing = std::sqrt(4 * 3.14159265 / 8000);
  for (Vec3& p : s.points) {
    for (double& c : p) c += 0.7 * spacing * random.gaussian();
  }
  const Orientation o = orient(s.points);
  EXPECT_TRUE(o.stats.consistent);
  const auto unsure = std::count_if(o.confidence.begin(), o.confidence.end(), [](float c) { return c < 0.5F; });
  EXPECT_LT(static_cast<double>(unsure), 0.1 * 8000);
  const auto sure = std::count_if(o.confidence.begin(), o.confidence.end(), [](float c) { return c > 0.9F; });
  EXPECT_GT(static_cast<double>(sure), 0.5 * 8000);
  EXPECT_GT(shapes::share_correct(o.normals, s.normals), 0.99);
}

TEST(Field, IsOneInsideAndZeroOutside) {
  const Surface s = shapes::sphere(8000, 2, {10, 20, 30});
  Orientation o;
  o.normals = s.normals;
  o.areas = s.areas;
  const Field field(s.points, o);
  const std::vector<Vec3> queries{{10, 20, 30}, {10.5, 20, 29}, {13, 20, 30}, {100, 20, 30}, {10, 22, 30}};
  const std::vector<double> w = field.value(queries);
  EXPECT_NEAR(w[0], 1, 5e-3);
  EXPECT_NEAR(w[1], 1, 5e-3);
  EXPECT_NEAR(w[2], 0, 5e-3);
  EXPECT_NEAR(w[3], 0, 5e-3);
  EXPECT_NEAR(w[4], 0.5, 0.1);
  const std::vector<double> alone = field.value(std::vector<Vec3>{queries[1]});
  EXPECT_EQ(alone[0], w[1]);  // a query's value does not depend on the others
}

// In the units of the caller, near the surface and far away, by differences of the field itself.
TEST(Field, GradientIsTheDerivativeOfTheValue) {
  for (const double size : {1e-3, 2.0, 5e4}) {
    const shapes::Surface s = shapes::sphere(1500, size, {10 * size, -20 * size, 3 * size});
    Orientation o;
    o.normals = s.normals;
    o.areas = s.areas;
    const Field field(s.points, o, 0.4 * size);
    const double step = 0.02 * size;
    for (const Vec3& at : {Vec3{0, 0, 1.1}, Vec3{0.5, 0.5, 0.3}, Vec3{-0.7, 0.9, 0}, Vec3{0, -0.9, 0.2}}) {
      const Vec3 x{(10 + at[0]) * size, (-20 + at[1]) * size, (3 + at[2]) * size};
      std::vector<Vec3> beside;
      for (std::size_t a = 0; a < 3; ++a) {
        for (const double side : {-step, step}) {
          beside.push_back(x);
          beside.back()[a] += side;
        }
      }
      const std::vector<double> w = field.value(beside);
      const Vec3 g = field.gradient(std::vector<Vec3>{x})[0];
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR((w[2 * a + 1] - w[2 * a]) / (2 * step) * size, g[a] * size, 5e-3) << size;
    }
  }
}

TEST(Field, LeavesOutWhatIsNotFinite) {
  const Surface s = shapes::sphere(2000);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Orientation o;
  o.normals = s.normals;
  o.areas = s.areas;
  o.normals[3][1] = kNan;
  o.areas[7] = kNan;
  o.areas[9] = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(Field(s.points, o).value(std::vector<Vec3>{{0, 0, 0}})[0], 1, 0.02);
  o.areas.pop_back();
  try {
    (void)Field(s.points, o);
    FAIL() << "fewer areas than points";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("1999 areas"), std::string::npos);
  }
}

}  // namespace
}  // namespace g3r
