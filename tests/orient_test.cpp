// orient() as a user sees it: right sides on every topology, what input may be, clear errors.
#include <g3r/g3r.h>

#include "shapes.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace
}  // namespace g3r
