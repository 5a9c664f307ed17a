#include "orient/settings.h"

#include "shapes.h"

#include <gtest/gtest.h>

namespace g3r {
namespace {

const CanonicalCloud& cloud() {
  static const CanonicalCloud made = canonical_cloud(shapes::sphere(500).points);
  return made;
}

Settings chosen(const Options& options) { return choose_settings(options, cloud(), cloud().set.spacing(), 0, 0); }

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
  EXPECT_EQ(s.polish.steps, 0);
  EXPECT_FALSE(s.coarse_to_fine);
  EXPECT_GE(s.epsilon.typical(), 0.15 * cloud().set.spacing());
}

TEST(ChooseSettings, RefusesOptionsThatContradictEachOther) {
  const auto refused = [](const auto& set) {
    Options options;
    set(options);
    EXPECT_THROW((void)chosen(options), InvalidInput);
  };
  refused([](Options& o) { o.degree = 2, o.harmonics = "1,x"; });
  refused([](Options& o) { o.degree = 2, o.method = Method::kEnergy; });
  refused([](Options& o) { o.degree = -3; });
  refused([](Options& o) { o.solver = Solver::kDense; });
  refused([](Options& o) { o.condition_number = true; });
  refused([](Options& o) { o.tolerance = 1; });
  refused([](Options& o) { o.threads = -1; });
  refused([](Options& o) { o.epsilon = {Length::Unit::kInput, 0}; });
  refused([](Options& o) { o.noise = {Length::Unit::kInput, 0}, o.preset = Preset::kPaper; });
  for (const Method method : {Method::kGreen, Method::kWnnc, Method::kAgr, Method::kPgr}) {
    refused([method](Options& o) { o.noise = {Length::Unit::kSpacing, 1}, o.method = method; });
  }
}

TEST(GivenNoise, IsTheSameLengthInEveryUnit) {
  const double h = cloud().set.spacing();
  EXPECT_FALSE(given_noise({}, cloud(), h));
  EXPECT_DOUBLE_EQ(*given_noise({Length::Unit::kSpacing, 0.5}, cloud(), h), 0.5 * h);
  const double world = cloud().frame.length_to_world(0.5 * h);
  EXPECT_NEAR(*given_noise({Length::Unit::kInput, world}, cloud(), h), 0.5 * h, 1e-12);
  EXPECT_THROW((void)given_noise({Length::Unit::kInput, -1}, cloud(), h), InvalidInput);
}

// A method that is named takes the steps that it has by itself; what others have published has none of ours.
TEST(StepsLeftOut, AreThoseThatAMethodHasNot) {
  Options options;
  EXPECT_TRUE(steps_left_out(options).none());
  options.method = Method::kEnergy;
  EXPECT_TRUE(steps_left_out(options).none());
  options.without = "jets";
  EXPECT_EQ(steps_left_out(options), parse_steps("jets"));
  options = {};
  options.degree = 2;  // least squares
  EXPECT_EQ(steps_left_out(options), parse_steps("sites,coarse-start,noise-choice,areas"));
  options = {};
  options.preset = Preset::kPaper;
  const StepSet ours = parse_steps("viewpoint,outliers,noise,sites,coarse-start,polish,noise-choice");
  EXPECT_EQ(steps_left_out(options), ours | parse_steps("areas"));
  options.method = Method::kEnergy;
  EXPECT_EQ(steps_left_out(options), ours);
  options = {};
  options.method = Method::kWnnc;  // the noise is what its confidence counts
  EXPECT_EQ(steps_left_out(options), parse_steps("viewpoint,outliers,sites,coarse-start,polish,noise-choice,areas"));
}

TEST(StartsCoarse, OnlyWhereItIsAskedForAndPointsAreMany) {
  Settings s;
  EXPECT_FALSE(starts_coarse(s, 1'000'000));
  s.coarse_to_fine = true;
  EXPECT_FALSE(starts_coarse(s, 1000));
  EXPECT_TRUE(starts_coarse(s, 1'000'000));
}

}  // namespace
}  // namespace g3r
