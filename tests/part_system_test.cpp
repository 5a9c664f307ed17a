// The equations of a part of the points, the others being held.
#include "solve/part_system.h"

#include "base/median.h"
#include "base/vector.h"
#include "cloud/canonical_cloud.h"
#include "orient/unsure.h"
#include "shapes.h"
#include "solve/energy_system.h"
#include "sum/fast_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace g3r {
namespace {

constexpr double kMajor = 0.6;
constexpr double kMinor = 0.25;
constexpr double kWidth = 0.8;  // spacings
const std::vector<Steps> kSteps{{20, StepKind::kConjugateGradient}};

struct Torus {
  CanonicalCloud cloud = canonical_cloud(shapes::torus(8000, kMajor, kMinor, 1).points);
  double h = cloud.set.spacing();
  double weight = 30 * h * h * h;

  // The true area vectors, in the cloud's frame.
  [[nodiscard]] std::vector<Vec3> areas() const {
    std::vector<Vec3> eta(cloud.size());
    const double major = cloud.frame.length_to_unit(kMajor);
    for (std::size_t i = 0; i < eta.size(); ++i) {
      const Vec3& p = cloud.points()[i];
      const double around = major / std::hypot(p[0], p[1]);
      eta[i] = vector::scale(vector::normalised({p[0] * (1 - around), p[1] * (1 - around), p[2]}), h * h);
    }
    return eta;
  }
};

// Of all points they are the equations that were there before: the same steps from the same start.
TEST(PartSystem, OfAllPointsIsTheWhole) {
  const Torus torus;
  FastSum sum(torus.cloud.points(), Widths(kWidth * torus.h), sum_plan(1e-3, torus.cloud.size()));
  EnergySystem system(sum, 0, torus.weight);
  std::vector<Vec3> start = torus.areas();
  for (std::size_t i = 0; i < start.size(); i += 3) start[i] = {0, 0, 0};
  std::vector<std::uint32_t> all(start.size());
  std::iota(all.begin(), all.end(), 0U);
  const IterativeResult whole = solve_iteratively(system, kSteps, 0, start, {});
  const IterativeResult part = solve_for_part(system, residual_at(all, system, start), kSteps, 0, {});
  constexpr double kRounding = 1e-6;  // grows with every step
  ASSERT_EQ(whole.residuals.size(), part.residuals.size());
  for (std::size_t k = 0; k < whole.residuals.size(); ++k) EXPECT_NEAR(part.residuals[k] / whole.residuals[k], 1, kRounding) << k;
  double error = 0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Vec3 d = vector::subtract(vector::add(start[i], part.eta[i]), whole.eta[i]);
    error = std::max(error, std::sqrt(vector::dot(d, d)));
  }
  EXPECT_LT(error, kRounding * torus.h * torus.h);
}

// A patch whose sides are wrong turns back while all else is held.
TEST(PartSystem, TurnsAPatchThatIsWrong) {
  const Torus torus;
  const std::vector<Vec3>& points = torus.cloud.points();
  FastSum sum(points, Widths(kWidth * torus.h), sum_plan(1e-3, points.size()));
  EnergySystem system(sum, 0, torus.weight);
  std::vector<Vec3> truth = torus.areas();
  const double factor = 0.5 / median(sum.winding(truth));  // what areas a spacing squared lack
  for (Vec3& v : truth) v = vector::scale(v, factor);
  std::vector<Vec3> start = truth;
  std::vector<std::uint8_t> wrong(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 d = vector::subtract(points[i], points[0]);
    if (std::sqrt(vector::dot(d, d)) > 3 * torus.h) continue;
    wrong[i] = 1;
    start[i] = vector::scale(start[i], -0.3);
  }
  const std::vector<std::uint32_t> some = around_unsure(points, {torus.h}, wrong);
  ASSERT_LT(some.size(), points.size() / 2);
  const std::vector<Vec3> part_points = values_at(some, points);
  FastSum part_sum(part_points, Widths(kWidth * torus.h), sum_plan(1e-3, some.size()));
  EnergySystem part(part_sum, 0, torus.weight);
  constexpr double kTolerance = 2.5e-3;  // of the program; with more steps random samples are fitted
  const std::vector<Vec3> change = solve_for_part(part, residual_at(some, system, start), kSteps, kTolerance, {}).eta;
  std::size_t against = 0;
  for (std::size_t k = 0; k < some.size(); ++k) {
    if (vector::dot(vector::add(start[some[k]], change[k]), truth[some[k]]) < 0) ++against;
  }
  const auto turned = static_cast<std::size_t>(std::count(wrong.begin(), wrong.end(), 1));
  EXPECT_LE(10 * against, turned);  // single points of random samples stay
}

TEST(AroundUnsure, IsWithinFiveSpacings) {
  std::vector<Vec3> line;
  std::vector<std::uint8_t> unsure(1000, 0);
  for (int i = 0; i < 1000; ++i) line.push_back({i * 1e-3, 0, 0});
  EXPECT_TRUE(around_unsure(line, {1e-2}, unsure).empty());
  unsure[300] = unsure[310] = 1;
  std::vector<std::uint32_t> expected(109);  // from 251 to 359
  std::iota(expected.begin(), expected.end(), 251U);
  EXPECT_EQ(around_unsure(line, {0.9999e-2}, unsure), expected);
  EXPECT_EQ(around_unsure(line, std::vector<double>(1000, 0.9999e-2), unsure), expected);
}

}  // namespace
}  // namespace g3r
