// Clouds made from seeds, held to what must hold for every cloud, and the cases that are kept (tests/stress_cases). bench/stress.cpp
// runs any number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "run_apart.h"
#include "run_options.h"
#include "sampling.h"
#include "sanitized.h"
#include "shrink.h"
#include "temporary_folder.h"

namespace g3r::stress {
namespace {

constexpr std::uint64_t kSeed = 5000;
constexpr std::uint64_t kClouds = kSanitized ? 8 : 200;
constexpr std::size_t kLargest = 60;
constexpr std::uint64_t kOneByProgram = 8;  // of so many clouds one is given to the program too

// Sides too: no cloud of so few points is sure of any (limit_to_evidence()). The program, where ctest says that it is, has the options that
// a recipe names.
TEST(Stress, ShortSetHolds) {
  Demands by_program;
  if (const char* program = std::getenv("G3R_PROGRAM")) by_program.program = program;
  for (std::uint64_t seed = kSeed; seed < kSeed + kClouds; ++seed) {
    const Recipe recipe = random_recipe(seed, kLargest);
    const Demands demands = seed % kOneByProgram == 0 ? by_program : Demands();
    for (const Finding& f : hold_apart(recipe, demands).findings) ADD_FAILURE() << recipe.line() << ' ' << f.kind << ": " << f.what;
  }
  RecordProperty("clouds", static_cast<int>(kClouds));
}

TEST(Stress, KeptCasesHold) {
  std::size_t cases = 0;
  for (const auto& entry : std::filesystem::directory_iterator(G3R_STRESS_CASES)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const Case kept = from_text({std::istreambuf_iterator<char>(in), {}});
    for (const Finding& f : hold_apart(kept, {}).findings) ADD_FAILURE() << entry.path() << ' ' << f.kind << ": " << f.what;
    ++cases;
  }
  EXPECT_GT(cases, 0U);
}

TEST(Stress, SameRecipeSameBytes) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Case a{random_recipe(seed, 200), make_scene(random_recipe(seed, 200))};
    const Case b{random_recipe(seed, 200), make_scene(random_recipe(seed, 200))};
    EXPECT_EQ(to_text(a), to_text(b));
  }
}

TEST(Stress, CasesComeBackFromText) {
  const Recipe recipe("shape=solid parts=2 points=30 missing=2 offset=utm float32=1 seed=3 method=green schedule=3_sd_30_cg");
  const Case made{recipe, make_scene(recipe)};
  const Case back = from_text(to_text(made));
  EXPECT_EQ(to_text(back), to_text(made));
  ASSERT_EQ(back.scene.points.size(), made.scene.points.size());
  EXPECT_EQ(run_options(back).options.schedule, "3 sd 30 cg");
}

// Every family and sampling: places on the surface, and normals across which the value changes from inside to outside.
TEST(Stress, SamplesLieOnTheirSurface) {
  for (const char* family : {"solid", "shell", "wire", "patch", "terrain", "room"}) {
    for (const char* sampling : {"uniform", "uneven", "lines", "raster", "views"}) {
      const Shape shape = make_shape(family, 3, 7);
      const Sampled sampled = sample(shape, sampling, 100, 7);
      EXPECT_GE(sampled.points.size(), 10U) << family << ' ' << sampling;
      for (const Vec3& p : sampled.points) {
        EXPECT_LT(std::abs(shape.value(p)), 1e-9) << family << ' ' << sampling;
        const Vec3 n = normal_of(shape, p);
        constexpr double kStep = 1e-4;
        EXPECT_GT(shape.value({p[0] + kStep * n[0], p[1] + kStep * n[1], p[2] + kStep * n[2]}), 0) << family << ' ' << sampling;
      }
    }
  }
}

TEST(Stress, AreaOfABall) {
  const Shape ball{[](const Vec3& p) { return std::hypot(p[0], p[1], p[2]) - 1; }, [](const Vec3&) { return true; }};
  constexpr double kSeeds = 20;
  constexpr double kFromLines = 0.03;  // four standard deviations of the mean of 20 times 2000 lines
  double sum = 0;
  for (int seed = 0; seed < kSeeds; ++seed) sum += sample(ball, "uniform", 10, static_cast<std::uint64_t>(seed)).area;
  EXPECT_NEAR(sum / kSeeds / (4 * 3.14159265), 1, kFromLines);
}

TEST(Stress, RecipesWithWordsThatAreNoneAreRefused) {
  for (const char* option : {"preset=papier", "method=grene", "trim=yes", "epsilon=2x", "noise_given=some", "epsilon=", "degree=two"}) {
    const Recipe recipe(std::string("shape=solid points=20 seed=1 ") + option);
    EXPECT_THROW((void)run_options({recipe, make_scene(recipe)}), InvalidInput) << option;
  }
}

std::vector<std::string> kinds(const Outcome& outcome) {
  std::vector<std::string> all;
  for (const Finding& f : outcome.findings) all.push_back(f.kind);
  return all;
}

// Results that are right but for one thing, which is found.
class SpoiltResult : public testing::Test {
 protected:
  using Kinds = std::vector<std::string>;

  static void SetUpTestSuite() {
    const Recipe recipe("shape=solid parts=1 points=600 seed=3");
    tested = {recipe, make_scene(recipe)};
    const RunOptions run = run_options(tested);
    right = reconstruct(tested.scene.points, run.options, run.mesh);
  }
  // Of a result that `spoil` has changed.
  template <class Spoil>
  static Kinds found(const Spoil& spoil) {
    Reconstruction result = right;
    spoil(result);
    return kinds(hold_result(tested, result, true));
  }
  static void turn_all(Reconstruction& r) {
    for (Vec3& n : r.orientation.normals) n = {-n[0], -n[1], -n[2]};
    std::fill(r.orientation.confidence.begin(), r.orientation.confidence.end(), 1.0F);
  }

  static inline Case tested;
  static inline Reconstruction right;
};

TEST_F(SpoiltResult, RightAsItIs) {
  EXPECT_EQ(found([](Reconstruction&) {}), Kinds{});
}

TEST_F(SpoiltResult, Numbers) {
  EXPECT_EQ(found([](Reconstruction& r) { r.orientation.normals[7] = {NAN, 0, 0}; }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.orientation.normals[7][0] += 0.1; }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.orientation.areas[7] = -1; }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.orientation.confidence[7] = NAN; }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.orientation.areas.pop_back(); }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.confidence[7] = 1.5F; }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.confidence[7] = NAN; }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.confidence.pop_back(); }), Kinds{"number"});
  EXPECT_EQ(found([](Reconstruction& r) { r.orientation.stats.spacing = NAN; }), Kinds{"number"});
}

TEST_F(SpoiltResult, Meshes) {
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.vertices[7][1] = NAN; }), Kinds{"mesh"});
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.vertices[7][1] = INFINITY; }), Kinds{"mesh"});
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.triangles.clear(); }), Kinds{"mesh"});
  EXPECT_EQ(found([](Reconstruction& r) { r.mesh.triangles.pop_back(); }), (Kinds{"mesh", "weld"}));
  EXPECT_EQ(found([](Reconstruction& r) { std::swap(r.mesh.triangles[7][0], r.mesh.triangles[7][1]); }), (Kinds{"mesh", "weld"}));
}

TEST_F(SpoiltResult, SidesWithoutAWarningOfThem) {
  EXPECT_EQ(found(turn_all), Kinds{"confidence"});
  EXPECT_EQ(found([](Reconstruction& r) {
              turn_all(r);
              r.orientation.stats.warnings = {
                  "3 points with a non-finite coordinate were left out",
                  "nothing was trimmed: no surface is farther than 4 spacings from the points",
                  "trimmed at 0.1, which is less than the gaps between the points and leaves holes: 4 spacings are 1",
                  "so few triangles intersect each other: 1 pair more than before simplifying",
                  "40 triangles instead of 30: fewer would open the mesh"};
            }),
            Kinds{"confidence"});
  EXPECT_EQ(found([](Reconstruction& r) {
              turn_all(r);
              r.orientation.stats.warnings = {"the points fill a volume"};
            }),
            Kinds{});
  EXPECT_EQ(found([](Reconstruction& r) {
              turn_all(r);
              r.orientation.stats.consistent = false;
            }),
            Kinds{});
}

TEST_F(SpoiltResult, FilesOfTheProgram) {
  const Orientation& o = right.orientation;
  Cloud file;
  file.normals = o.normals;
  file.confidence = o.confidence;
  EXPECT_EQ(difference_in_file(file, o), "");
  const auto differs = [&](const auto& spoil) {
    Cloud spoilt = file;
    spoil(spoilt);
    return !difference_in_file(spoilt, o).empty();
  };
  EXPECT_TRUE(differs([](Cloud& c) { c.normals[7][2] += 1e-3; }));
  EXPECT_TRUE(differs([](Cloud& c) { c.normals[7] = {NAN, NAN, NAN}; }));
  EXPECT_TRUE(differs([](Cloud& c) { c.confidence[7] = std::nextafter(c.confidence[7], 2.0F); }));
  EXPECT_TRUE(differs([](Cloud& c) { c.normals.clear(); }));
  EXPECT_TRUE(differs([](Cloud& c) { c.confidence.clear(); }));
}

// A failure that needs 3 points that are not finite is shrunk to these.
TEST(Stress, FailuresShrink) {
  const Recipe recipe("shape=solid parts=4 points=200 missing=5 noise=0.1 offset=utm seed=1 preset=paper");
  const auto fails = [](const Case& c) {
    return std::count_if(c.scene.points.begin(), c.scene.points.end(), [](const Vec3& p) { return !std::isfinite(p[0] + p[1] + p[2]); }) >=
           3;
  };
  const Case small = shrink(recipe, fails, true, 200);
  EXPECT_EQ(small.scene.points.size(), 3U);
  EXPECT_TRUE(fails(small));
  EXPECT_EQ(small.recipe.line(), "missing=5 parts=1 points=6 seed=1 shape=solid");
}

TEST(Stress, FindingsComeOutOfTheirProcess) {
  Demands demands;
  demands.program = "/bin/false";
  const Outcome outcome = hold_apart(Recipe("shape=solid points=50 seed=1"), demands);
  ASSERT_EQ(outcome.findings.size(), 1U);
  EXPECT_EQ(outcome.findings[0].kind, "program");
  EXPECT_EQ(outcome.findings[0].what, "g3r ends with 1");
  EXPECT_GT(outcome.cpu_seconds, 0);
}

// What waits for ever takes no time of the processor.
TEST(Stress, HangsAreFindings) {
  const TemporaryFolder folder;
  Demands demands;
  demands.program = folder.file("hangs");
  std::ofstream(demands.program) << "#!/bin/sh\nexec sleep 100000\n";
  std::filesystem::permissions(demands.program, std::filesystem::perms::owner_all);
  const Outcome outcome = hold_apart(Recipe("shape=solid points=20 seed=1"), demands, {600, 8ULL << 30, 5});
  ASSERT_EQ(outcome.findings.size(), 1U);
  const std::string& kind = outcome.findings[0].kind;
  EXPECT_TRUE(kind == "program" || kind == "crash") << kind;  // the second where the runs before take so long
}

// A run that is too long, too large or ends by a signal is a finding.
TEST(Stress, LimitsAreFindings) {
  const Recipe recipe("shape=solid points=20000 seed=1");
  const Outcome outcome = hold_apart(recipe, {}, {1, 8ULL << 30});
  ASSERT_EQ(outcome.findings.size(), 1U);
  EXPECT_EQ(outcome.findings[0].kind, "crash");
}

}  // namespace
}  // namespace g3r::stress
