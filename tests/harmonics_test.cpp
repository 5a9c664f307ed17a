// Solid harmonics: closed forms, harmonicity, mean value, orthonormality, gradients, names.
#include "solve/harmonics.h"

#include "shapes.h"

#include <g3r/error.h>

#include <gtest/gtest.h>

namespace g3r {
namespace {

const std::vector<Harmonic> kAll = harmonics_of_degrees(0, kMaxHarmonicDegree);

TEST(Harmonics, LowDegreesHaveTheirClosedForms) {
  const double x = 0.3;
  const double y = -0.7;
  const double z = 0.5;
  const HarmonicValues u = evaluate_harmonics(harmonics_of_degrees(0, 2), {{x, y, z}});
  const double expected[9] = {0.28209479177387814,
                              0.4886025119029199 * y,
                              0.4886025119029199 * z,
                              0.4886025119029199 * x,
                              1.0925484305920792 * x * y,
                              1.0925484305920792 * y * z,
                              0.31539156525252005 * (2 * z * z - x * x - y * y),
                              1.0925484305920792 * x * z,
                              0.5462742152960396 * (x * x - y * y)};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(u.value[k], expected[k], 1e-15) << k;
}

TEST(Harmonics, GradientsAreDerivativesAndLaplaciansVanish) {
  shapes::Random random(1);
  const double step = 1e-3;  // central differences of polynomials of degree <= 8: truncation below 1e-5
  for (int trial = 0; trial < 10; ++trial) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    std::vector<Vec3> at{p};
    for (std::size_t a = 0; a < 3; ++a) {
      for (const double s : {-step, step}) {
        at.push_back(p);
        at.back()[a] += s;
      }
    }
    const HarmonicValues u = evaluate_harmonics(kAll, at);
    for (std::size_t k = 0; k < u.count; ++k) {
      double laplacian = -6 * u.value[k];
      for (std::size_t a = 0; a < 3; ++a) {
        const double minus = u.value[(1 + 2 * a) * u.count + k];
        const double plus = u.value[(2 + 2 * a) * u.count + k];
        laplacian += minus + plus;
        EXPECT_NEAR((plus - minus) / (2 * step), u.gradient[k][a], 2e-3);
      }
      double divergence = 0;  // of the gradient: exact harmonicity
      for (std::size_t a = 0; a < 3; ++a) {
        divergence += (u.gradient[(2 + 2 * a) * u.count + k][a] - u.gradient[(1 + 2 * a) * u.count + k][a]) / (2 * step);
      }
      EXPECT_NEAR(laplacian / (step * step), 0, 2e-2) << kAll[k].degree << ":" << kAll[k].order;
      EXPECT_NEAR(divergence, 0, 2e-2);
    }
  }
}

TEST(Harmonics, MeanOverASphereIsTheValueAtItsCentre) {
  const Vec3 centre{0.2, -0.1, 0.4};
  const shapes::Surface ball = shapes::sphere(20000, 0.5, centre);
  const HarmonicValues u = evaluate_harmonics(kAll, ball.points);
  const HarmonicValues at_centre = evaluate_harmonics(kAll, {centre});
  for (std::size_t k = 0; k < u.count; ++k) {
    double mean = 0;
    for (std::size_t i = 0; i < ball.points.size(); ++i) mean += u.value[i * u.count + k];
    EXPECT_NEAR(mean / static_cast<double>(ball.points.size()), at_centre.value[k], 1e-6);
  }
}

TEST(Harmonics, AreOrthonormalOnTheUnitSphere) {
  const shapes::Surface ball = shapes::sphere(40000, 1);
  const HarmonicValues u = evaluate_harmonics(kAll, ball.points);
  for (std::size_t k = 0; k < u.count; ++k) {
    for (std::size_t j = 0; j <= k; ++j) {
      double product = 0;
      for (std::size_t i = 0; i < ball.points.size(); ++i) product += ball.areas[i] * u.value[i * u.count + k] * u.value[i * u.count + j];
      EXPECT_NEAR(product, k == j ? 1 : 0, 1e-3);
    }
  }
}

TEST(Harmonics, TextsNameSubsetsAndFormatRoundTrips) {
  EXPECT_EQ(parse_harmonics("degree:0-2").size(), 9U);
  EXPECT_EQ(parse_harmonics("x, y, z"), (std::vector<Harmonic>{{1, 1}, {1, -1}, {1, 0}}));
  EXPECT_EQ(parse_harmonics("1,degree:3").size(), 8U);
  for (const char* text : {"degree:0-2", "degree:3", "1,x,y,z", "1", "xy,4:-3", "x2-y2,z2"}) {
    EXPECT_EQ(parse_harmonics(format_harmonics(parse_harmonics(text))), parse_harmonics(text)) << text;
  }
  for (const char* bad : {"", "q", "degree:", "degree:2-1", "degree:9", "degree:-1", "x,x", "2:3", "1,,x", "degree:0-2,xy"}) {
    EXPECT_THROW(static_cast<void>(parse_harmonics(bad)), InvalidInput) << bad;
  }
}

}  // namespace
}  // namespace g3r
