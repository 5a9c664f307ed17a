#include "orient/settings.h"

#include "shapes.h"

#include <gtest/gtest.h>

#include <vector>

namespace g3r {
namespace {

const CanonicalCloud& cloud() {
  static const CanonicalCloud made = canonical_cloud(shapes::sphere(500).points);
  return made;
}

Settings chosen(const Options& options, double noise = 0) { return choose_settings(options, cloud(), cloud().set.spacing(), noise, 0); }

TEST(ChooseSettings, WhatIsGivenWinsOverThePreset) {
  for (const Preset preset : {Preset::kDefault, Preset::kPaper}) {
    Options options;
    options.preset = preset;
    options.epsilon = {Length::Unit::kSpacing, 0.7};
    options.schedule = "3 sd 5 cg";
    options.tolerance = 0.125;
    const Settings s = chosen(options);
    EXPECT_DOUBLE_EQ(s.epsilon.typical(), 0.7 * cloud().set.spacing());
    EXPECT_EQ(s.schedule_text, "3 sd 5 cg");
    EXPECT_EQ(s.tolerance, 0.125);
  }
}

TEST(ChooseSettings, ThePaperHasItsStepsAndNothingAfterThem) {
  Options options;
  options.preset = Preset::kPaper;
  const Settings s = chosen(options);
  EXPECT_EQ(s.method, Method::kGreen);
  EXPECT_EQ(s.schedule_text, "20 sd 60 cg");
  EXPECT_EQ(s.refinement_width.typical(), 0);
  EXPECT_EQ(s.polish_steps, 0);
  EXPECT_FALSE(s.coarse_to_fine);
  EXPECT_GE(s.epsilon.typical(), 0.15 * cloud().set.spacing());
}

TEST(ChooseSettings, WidthsGrowWithTheNoise) {
  const double h = cloud().set.spacing();
  double epsilon = 0, refinement = 0, polish = 0;
  for (const double noise : {0.0, 0.2, 0.5, 1.0, 2.0}) {
    const Settings s = chosen({}, noise * h);
    EXPECT_GE(s.epsilon.typical(), epsilon);
    EXPECT_GE(s.refinement_width.typical(), refinement);
    EXPECT_GE(s.polish_width.typical(), polish);
    epsilon = s.epsilon.typical();
    refinement = s.refinement_width.typical();
    polish = s.polish_width.typical();
  }
  EXPECT_GT(epsilon, chosen({}).epsilon.typical());
}

// The smallest noise is that of clean clouds, and 5 % more of it changes no width by more than 10 %.
TEST(ChooseSettings, WidthsFollowTheNoiseWithoutAJump) {
  const double h = cloud().set.spacing();
  const auto widths = [](const Settings& s) {
    return std::vector<double>{s.epsilon.typical(), s.refinement_width.typical(), s.polish_epsilon.typical(), s.polish_width.typical()};
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
TEST(ChooseSettings, AWideEpsilonMeansTheNoiseThatItHides) {
  const double h = cloud().set.spacing();
  for (const double noise : {0.8, 1.5, 3.0}) {
    const Settings noisy = chosen({}, noise * h);
    Options options;
    options.epsilon = {Length::Unit::kSpacing, noisy.epsilon.typical() / h};
    const Settings wide = chosen(options);
    EXPECT_NEAR(wide.noise, noise * h, 1e-9 * h);
    EXPECT_NEAR(wide.polish_width.typical(), noisy.polish_width.typical(), 1e-9 * h);
  }
}

TEST(ChooseSettings, RefusesOptionsThatContradictEachOther) {
  const auto refused = [](const auto& set) {
    Options options;
    set(options);
    EXPECT_THROW((void)chosen(options), InvalidInput);
  };
  refused([](Options& o) { o.degree = 2, o.harmonics = "1,x"; });
  refused([](Options& o) { o.degree = 2, o.method = Method::kEnergy; });
  refused([](Options& o) { o.solver = Solver::kDense; });
  refused([](Options& o) { o.condition_number = true; });
  refused([](Options& o) { o.tolerance = 1; });
  refused([](Options& o) { o.threads = -1; });
  refused([](Options& o) { o.epsilon = {Length::Unit::kInput, 0}; });
  refused([](Options& o) { o.noise = {Length::Unit::kInput, 0}, o.preset = Preset::kPaper; });
}

TEST(GivenNoise, IsTheSameLengthInEveryUnit) {
  const double h = cloud().set.spacing();
  EXPECT_FALSE(given_noise({}, cloud(), h));
  EXPECT_DOUBLE_EQ(*given_noise({Length::Unit::kSpacing, 0.5}, cloud(), h), 0.5 * h);
  const double world = cloud().frame.length_to_world(0.5 * h);
  EXPECT_NEAR(*given_noise({Length::Unit::kInput, world}, cloud(), h), 0.5 * h, 1e-12);
  EXPECT_THROW((void)given_noise({Length::Unit::kInput, -1}, cloud(), h), InvalidInput);
}

TEST(StartsCoarse, OnlyWhereItIsAskedForAndPointsAreMany) {
  Settings s;
  EXPECT_FALSE(starts_coarse(s, 1'000'000));
  s.coarse_to_fine = true;
  EXPECT_FALSE(starts_coarse(s, 1000));
  EXPECT_TRUE(starts_coarse(s, 1'000'000));
}

TEST(PlannedMemory, HasASiteOfTheCertificateForEveryPointOnlyWithoutNoise) {
  Settings s;
  s.spacing = 0.01;
  const std::size_t clean = planned_memory(s, 100'000, 100'000);
  s.noise = 0.01;
  EXPECT_LT(static_cast<double>(planned_memory(s, 100'000, 100'000)), 0.8 * static_cast<double>(clean));
}

TEST(PlannedMemory, KnowsTheMatricesOfTheSums) {
  Settings s;
  s.spacing = 0.01;
  s.first_sums = sum_plan(1e-2, 10'000);
  const std::size_t usual = planned_memory(s, 10'000, 10'000);
  s.first_sums = sum_plan(1e-5, 10'000);
  EXPECT_GT(planned_memory(s, 10'000, 10'000), usual + 40'000'000);
  s.first_sums = sum_plan(0, 10'000);
  EXPECT_LT(planned_memory(s, 10'000, 10'000), usual);
}

TEST(PlannedMemory, GrowsWithEveryPointAndIsHeldToTheLimit) {
  Settings s;
  s.spacing = 0.01;
  EXPECT_LT(planned_memory(s, 1000, 1000), planned_memory(s, 2000, 1000));
  EXPECT_LT(planned_memory(s, 2000, 1000), planned_memory(s, 2000, 2000));
  s.dense = true;
  EXPECT_GE(planned_memory(s, 1000, 1000), 9 * 1000 * 1000 * sizeof(double));
  Options options;
  EXPECT_NO_THROW(require_memory(std::size_t{1} << 50, options));  // 0: no limit
  options.max_memory = 1000;
  EXPECT_NO_THROW(require_memory(1000, options));
  EXPECT_THROW(require_memory(1001, options), Unavailable);
}

}  // namespace
}  // namespace g3r
