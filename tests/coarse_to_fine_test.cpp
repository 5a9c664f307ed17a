#include "orient/coarse_to_fine.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "orient/start.h"
#include "sanitized.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r {
namespace {

Solved solved(const CanonicalCloud& cloud, const Settings& settings) {
  const Monitor monitor;
  Stages stages(monitor);
  return solve_coarse_to_fine(cloud.points(), settings, stages);
}

TEST(SolveCoarseToFine, OfFewPointsIsThePlainSolve) {
  const CanonicalCloud cloud = canonical_cloud(shapes::torus(900, 0.6, 0.25, 2).points);
  Settings settings = choose_settings({}, cloud, cloud.set.spacing(), 0, 0);
  ASSERT_FALSE(starts_coarse(settings, cloud.size()));
  const Solved with = solved(cloud, settings);
  settings.coarse_to_fine = false;
  const Solved without = solved(cloud, settings);
  EXPECT_EQ(with.result.eta, without.result.eta);
  EXPECT_EQ(with.refinement.normals, without.refinement.normals);
}

TEST(SolveCoarseToFine, FindsTheSidesOfABall) {
  const shapes::Surface sphere = shapes::sphere(900);
  const CanonicalCloud cloud = canonical_cloud(sphere.points);
  Settings settings = choose_settings({}, cloud, cloud.set.spacing(), 0, 0);
  const Solved found = solved(cloud, settings);
  std::size_t outward = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 &p = cloud.points()[i], &n = found.refinement.normals[i];
    if (p[0] * n[0] + p[1] * n[1] + p[2] * n[2] > 0) ++outward;
  }
  EXPECT_EQ(outward, cloud.size());
  EXPECT_TRUE(found.result.converged);
  settings.refinement_width = {};
  EXPECT_TRUE(solved(cloud, settings).refinement.normals.empty());
}

// The equations are not true of an open surface: more steps than the first ten would fit what is wrong.
TEST(SolveCoarseToFine, TakesNoMoreStepsForOpenSurfaces) {
  constexpr std::size_t kPoints = 42000;
  const double scatter = 0.1 * 2 / std::sqrt(static_cast<double>(kPoints));
  shapes::Random random(2);
  std::vector<Vec3> patch(kPoints);
  for (Vec3& p : patch) {
    const double x = random.uniform(-1, 1);
    const double y = random.uniform(-1, 1);
    p = {x, y, 0.15 * std::sin(5 * x) * std::cos(4 * y) + scatter * random.gaussian()};
  }
  const CanonicalCloud cloud = canonical_cloud(patch);
  const Settings settings = choose_settings({}, cloud, cloud.set.spacing(), cloud.frame.length_to_unit(0.8 * scatter), 0);
  ASSERT_TRUE(starts_coarse(settings, cloud.size()));
  EXPECT_LE(solved(cloud, settings).result.residuals.size(), 10U);
}

// True normals leave less to do than the solution on a quarter of the points; those of other points leave nearly everything.
TEST(SolveCoarseToFine, MayStartFromWhatIsKnown) {
  if (kSanitized) GTEST_SKIP() << "any_size_test starts its tiles so";
  const shapes::Surface torus = shapes::torus(42000, 0.6, 0.25, 2);  // in an order that is not the canonical one
  Options only_solve;
  only_solve.without = "polish,more-steps";
  const auto first_residual = [&](const std::vector<Vec3>& start) {
    return orient_from(torus.points, {start, {}, {}, {}}, only_solve, {}).stats.iterations.front().residual;
  };
  EXPECT_LT(first_residual(torus.normals), first_residual({}));
  EXPECT_GT(first_residual({torus.normals.rbegin(), torus.normals.rend()}), 0.5);
}

// Of a torus of which one half has been thinned, the equations are those of the whole where it is known how much: areas come out as large
// as the points that they stand for, which uniform kernels miss.
TEST(SolveCoarseToFine, KnowsWhatThinnedPointsStandFor) {
  constexpr std::size_t kEvery = 16;
  const shapes::Surface torus = shapes::torus(16000, 0.6, 0.25, 2);
  std::vector<Vec3> points, normals;
  std::vector<double> relative;
  for (std::size_t i = 0; i < torus.points.size(); ++i) {
    const bool thinned = torus.points[i][0] > 0;
    if (thinned && i % kEvery != 0) continue;
    points.push_back(torus.points[i]);
    normals.push_back(torus.normals[i]);
    relative.push_back(thinned ? 4 : 1);  // the square root of kEvery
  }
  const CanonicalCloud cloud = canonical_cloud(points);
  std::vector<double> known(cloud.size());
  for (std::size_t i = 0; i < points.size(); ++i) known[cloud.point_of[i]] = relative[i];
  const Monitor monitor;
  Stages stages(monitor);
  const Settings settings = choose_settings({}, cloud, cloud.set.spacing(), 0, 0);
  const Solved found = solve_coarse_to_fine(cloud.points(), settings, stages, known);
  const auto error_of = [&](const Solved& what) {
    double sum = 0;  // of 1 - cos
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& n = what.refinement.normals[cloud.point_of[i]];
      sum += 1 - (n[0] * normals[i][0] + n[1] * normals[i][1] + n[2] * normals[i][2]);
    }
    return sum / static_cast<double>(points.size());
  };
  EXPECT_LT(error_of(found), 0.5 * error_of(solve_coarse_to_fine(cloud.points(), settings, stages, {})));

  // And gradients compare, though kernels are wider: the polish starts from them.
  std::vector<double> dense, thinned;
  for (std::size_t i = 0; i < points.size(); ++i) {
    (relative[i] > 1 ? thinned : dense).push_back(found.refinement.strength[cloud.point_of[i]]);
  }
  EXPECT_NEAR(median(thinned) / median(dense), 1, 0.15);
}

// The directions of the points that are left as they are do not suffer: those of the field, not of fits to the points.
TEST(OrientFrom, ThinningFarPointsCostsNoDirections) {
  if (kSanitized) GTEST_SKIP() << "whole solves, whose result is what counts";
  constexpr std::size_t kEvery = 16;
  constexpr double kFarFromThem = 0.2;  // of the thinned ones: 9 spacings
  const shapes::Surface torus = shapes::torus(16000, 0.6, 0.25, 2);
  std::vector<Vec3> points;
  std::vector<double> relative;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < torus.points.size(); ++i) {
    const bool thinned = torus.points[i][0] > 0;
    if (thinned && i % kEvery != 0) continue;
    points.push_back(torus.points[i]);
    relative.push_back(thinned ? 4 : 1);
    of.push_back(i);
  }
  Options only_field;
  only_field.without = "jets,planes,creases,facets";
  const std::vector<Vec3> whole = orient(torus.points, only_field).normals;
  const std::vector<Vec3> half = orient_from(points, {{}, relative, {}, {}}, only_field, {}).normals;
  double error_of_whole = 0, error_of_half = 0;  // of 1 - cos
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (points[k][0] > -kFarFromThem) continue;
    error_of_whole += 1 - vector::dot(whole[of[k]], torus.normals[of[k]]);
    error_of_half += 1 - vector::dot(half[k], torus.normals[of[k]]);
  }
  EXPECT_LT(error_of_half, 1.05 * error_of_whole);
}

// The surroundings of the wanted points keep the directions of the field.
TEST(OrientFrom, OnlyWantedPointsOfANoisyCloudHaveFits) {
  shapes::Surface torus = shapes::torus(kSanitized ? 2500 : 6000, 0.6, 0.25, 2);
  shapes::Random random(3);
  Known known;
  for (Vec3& p : torus.points) {
    known.wanted.push_back(p[0] > 0 ? 1 : 0);
    for (double& x : p) x += 0.01 * random.gaussian();
  }
  Options no_fits;
  no_fits.without = "noisy-jets";
  const std::vector<Vec3> fitted = orient_from(torus.points, known, {}, {}).normals;
  const std::vector<Vec3> field = orient_from(torus.points, known, no_fits, {}).normals;
  std::size_t changed = 0, wanted = 0;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (known.wanted[i] == 0) {
      ASSERT_EQ(fitted[i], field[i]);
    } else {
      ++wanted;
      changed += fitted[i] != field[i] ? 1 : 0;
    }
  }
  EXPECT_GT(changed, wanted / 2);
}

// Points 10 times as far apart on one side as on the other: kernels as wide as the typical spacing are single points there.
TEST(OrientUneven, KernelsFollowTheDensity) {
  if (kSanitized) GTEST_SKIP() << "whole solves, whose result is what counts";
  const shapes::Surface torus = shapes::torus(60000, 0.6, 0.25, 2);
  shapes::Random random(3);
  std::vector<Vec3> points, normals;
  for (std::size_t i = 0; i < torus.points.size(); ++i) {
    const double along = (torus.points[i][0] + 0.85) / 1.7;  // 0 .. 1
    if (random.uniform() > std::pow(100.0, -along)) continue;
    points.push_back(torus.points[i]);
    normals.push_back(torus.normals[i]);
  }
  const auto error = [&](const std::string& without) {
    Options options;
    options.noise = {Length::Unit::kSpacing, 0};
    options.without = "jets,planes,creases,facets" + without;
    const std::vector<Vec3> found = orient(points, options).normals;
    double sum = 0;  // of 1 - cos
    for (std::size_t i = 0; i < points.size(); ++i) sum += 1 - vector::dot(found[i], normals[i]);
    return sum / static_cast<double>(points.size());
  };
  EXPECT_LT(error(""), 0.5 * error(",local-widths"));
}

}  // namespace
}  // namespace g3r
