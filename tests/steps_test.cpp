// Steps of orient() left out by name, for ablations.
#include "orient/steps.h"

#include <g3r/error.h>
#include <g3r/g3r.h>

#include "shapes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace g3r {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Orientation without(const std::vector<Vec3>& points, std::string_view steps) {
  Options options;
  options.without = steps;
  return orient(points, options);
}

TEST(Steps, AreParsedByName) {
  EXPECT_TRUE(parse_steps("").none());
  const StepSet two = parse_steps("jets,areas");
  EXPECT_EQ(two.count(), 2U);
  EXPECT_TRUE(contains(two, Step::kJets));
  EXPECT_TRUE(contains(two, Step::kAreas));
  for (std::size_t i = 0; i < kStepNames.size(); ++i) EXPECT_TRUE(parse_steps(kStepNames[i]).test(i)) << kStepNames[i];
}

TEST(Steps, OfOtherNamesAreRefusedWithTheNamesThereAre) {
  try {
    (void)without(shapes::sphere(50).points, "jets,jetz");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("'jetz'"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("noise-choice"), std::string::npos) << error.what();
  }
}

// The page that says what each step is worth has a row for every step, in the order of the run.
TEST(Steps, HaveARowEachInTheEvidence) {
  const std::string page = text_of(G3R_STEPS_PAGE);
  std::size_t from = 0;
  for (const std::string_view name : kStepNames) {
    from = page.find("\n| `" + std::string(name) + "` |", from);
    ASSERT_NE(from, std::string::npos) << name << " has no row, or not in the order of the run";
  }
}

TEST(Steps, LeaveTheRestOfTheRunSoundWhenLeftOut) {
  shapes::Surface ball = shapes::sphere(800);
  const Orientation all = orient(ball.points);
  for (const std::string_view name : kStepNames) {
    const Orientation o = without(ball.points, name);
    EXPECT_GE(shapes::share_correct(o.normals, ball.normals), 0.999) << name;
  }
  EXPECT_NE(without(ball.points, "jets").normals, all.normals);
  EXPECT_NE(without(ball.points, "polish").normals, all.normals);
  EXPECT_NE(without(ball.points, "areas").areas, all.areas);
}

TEST(Steps, LeftOutAreNotRun) {
  shapes::Surface ball = shapes::sphere(3000);
  ball.points.push_back({5, 5, 5});
  EXPECT_EQ(orient(ball.points).stats.outliers, 1U);
  EXPECT_EQ(without(ball.points, "outliers").stats.outliers, 0U);
  ball.points.pop_back();
  shapes::scatter(ball, 0.02);
  EXPECT_GT(orient(ball.points).stats.noise, 0);
  EXPECT_EQ(without(ball.points, "noise").stats.noise, 0);
  std::vector<Vec3> half;
  for (const Vec3& p : shapes::sphere(4000).points) {
    if (p[2] > 0) half.push_back(p);
  }
  EXPECT_GT(orient(half).stats.open_share, 0);
  EXPECT_EQ(without(half, "open-surfaces").stats.open_share, 0);
}

}  // namespace
}  // namespace g3r
