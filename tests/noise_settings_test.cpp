#include "orient/noise_settings.h"

#include "orient/projection.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace g3r {
namespace {

const CanonicalCloud& cloud() {
  static const CanonicalCloud made = canonical_cloud(shapes::sphere(500).points);
  return made;
}

Settings chosen(const Options& options, double noise = 0) { return choose_settings(options, cloud(), cloud().set.spacing(), noise, 0); }

// w = A s^2 / sqrt(s^2 + 1): the noise that a width hides is the noise that asks for it.
TEST(HiddenNoise, IsTheInverseOfTheWidth) {
  for (const double noise : {0.05, 0.3, 1.0, 4.0}) {
    const Settings s = chosen({}, noise * cloud().set.spacing());
    EXPECT_NEAR(hidden_noise(s.refinement_width.noise / s.spacing), noise, 1e-12) << noise;
  }
  EXPECT_NEAR(hidden_noise(kRefinementWidth), noise_of_clean_widths(), 1e-12);
}

TEST(NoiseSettings, WidthsGrowWithTheNoise) {
  const double h = cloud().set.spacing();
  double epsilon = 0, refinement = 0, polish = 0;
  for (const double noise : {0.0, 0.2, 0.5, 1.0, 2.0}) {
    const Settings s = chosen({}, noise * h);
    EXPECT_GE(s.epsilon.typical(), epsilon);
    EXPECT_GE(s.refinement_width.typical(), refinement);
    EXPECT_GE(s.polish.width.typical(), polish);
    epsilon = s.epsilon.typical();
    refinement = s.refinement_width.typical();
    polish = s.polish.width.typical();
  }
  EXPECT_GT(epsilon, chosen({}).epsilon.typical());
}

// The smallest noise is that of clean clouds, and 5 % more of it changes no width by more than 10 %.
TEST(NoiseSettings, WidthsFollowTheNoiseWithoutAJump) {
  const double h = cloud().set.spacing();
  const auto widths = [](const Settings& s) {
    return std::vector<double>{s.epsilon.typical(), s.refinement_width.typical(), s.polish.epsilon.typical(), s.polish.width.typical()};
  };
  EXPECT_EQ(widths(chosen({}, 1e-6 * h)), widths(chosen({})));
  EXPECT_EQ(chosen({}, 1e-6 * h).schedule_text, chosen({}).schedule_text);
  for (double noise = 0.01; noise < 4; noise *= 1.05) {
    const std::vector<double> before = widths(chosen({}, noise * h));
    const std::vector<double> after = widths(chosen({}, 1.05 * noise * h));
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_GE(after[i], before[i]) << noise;
      EXPECT_LE(after[i], 1.11 * before[i]) << noise;
    }
  }
}

// An epsilon as wide as noise would ask for is taken for that noise.
TEST(NoiseSettings, AWideEpsilonMeansTheNoiseThatItHides) {
  const double h = cloud().set.spacing();
  for (const double noise : {0.8, 1.5, 3.0}) {
    const Settings noisy = chosen({}, noise * h);
    Options options;
    options.epsilon = {Length::Unit::kSpacing, noisy.epsilon.typical() / h};
    const Settings wide = chosen(options);
    EXPECT_NEAR(wide.noise, noise * h, 1e-9 * h);
    EXPECT_NEAR(wide.polish.width.typical(), noisy.polish.width.typical(), 1e-9 * h);
  }
}

// Points that were moved onto their surface are polished by the law of the noise that is left, and by no other change.
TEST(AfterProjection, PolishesForTheNoiseThatIsLeft) {
  const double h = cloud().set.spacing();
  const Settings before = chosen({}, h);
  const Settings after = after_projection(before);
  const Settings less = chosen({}, projected_noise(h, h));
  EXPECT_LT(projected_noise(h, h), h);
  EXPECT_DOUBLE_EQ(after.polish.epsilon.typical(), less.polish.epsilon.typical());
  EXPECT_DOUBLE_EQ(after.polish.width.typical(), less.polish.width.typical());
  EXPECT_DOUBLE_EQ(after.polish.winding_weight, less.polish.winding_weight);
  EXPECT_EQ(after.noise, before.noise);
  EXPECT_EQ(after.epsilon.typical(), before.epsilon.typical());
}

}  // namespace
}  // namespace g3r
