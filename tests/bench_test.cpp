// The benchmark's own parts: what it measures on, how it names methods, what it computes and writes.
#include <g3r/error.h>
#include <g3r/metrics.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../bench/inputs.h"
#include "../bench/measure.h"
#include "../bench/results.h"
#include "../bench/variant.h"
#include "base/vector.h"
#include "mesh_shapes.h"
#include "sanitized.h"

namespace g3r::bench {
namespace {

constexpr std::size_t kCount = 20000;

Mesh bar() { return shapes::moved(shapes::square(1, 0, 4), {3, 2, 1}); }

TEST(BenchInputs, CleanIsTheSampleOfTheMesh) {
  const Input input = make_input(shapes::cube(), parse_input_kind("clean"), 100, 7);
  EXPECT_EQ(input.points, sample_mesh(shapes::cube(), 100, 7).points);
  EXPECT_EQ(input.surface, 100u);
}

TEST(BenchInputs, EveryKindHasTheCountAskedForAndDependsOnTheSeed) {
  for (const char* text : {"clean", "noise:0.5", "outliers:5", "gradient:10", "stripes:10", "patches:5", "pcpnet:stripes"}) {
    const InputKind kind = parse_input_kind(text);
    const Input first = make_input(shapes::sphere(1, 40), kind, 1000, 3);
    EXPECT_EQ(first.points.size(), 1000u) << text;
    EXPECT_EQ(first.normals.size(), first.surface) << text;
    EXPECT_EQ(first.points, make_input(shapes::sphere(1, 40), kind, 1000, 3).points) << text;
    EXPECT_NE(first.points, make_input(shapes::sphere(1, 40), kind, 1000, 4).points) << text;
  }
}

// Standard deviation of a coordinate's displacement, in percent of the cube's diagonal.
double noise_of(const char* kind) {
  const Input clean = make_input(shapes::cube(), parse_input_kind("clean"), kCount, 1);
  const Input noisy = make_input(shapes::cube(), parse_input_kind(kind), kCount, 1);
  double sum = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec3 d = vector::subtract(noisy.points[i], clean.points[i]);
    sum += vector::dot(d, d);
  }
  return 100 * std::sqrt(sum / (3 * kCount)) / std::sqrt(3.0);
}

TEST(BenchInputs, NoiseIsInPercentOfTheDiagonal) { EXPECT_NEAR(noise_of("noise:1"), 1, 0.02); }

TEST(BenchInputs, PcpnetHasItsLevelsOfNoise) {
  EXPECT_EQ(noise_of("pcpnet:clean"), 0);
  EXPECT_NEAR(noise_of("pcpnet:0.12"), 0.12, 0.02 * 0.12);
  EXPECT_NEAR(noise_of("pcpnet:0.6"), 0.6, 0.02 * 0.6);
  EXPECT_NEAR(noise_of("pcpnet:1.2"), 1.2, 0.02 * 1.2);
}

TEST(BenchInputs, OutliersComeLastAndFillALargerBox) {
  const Input input = make_input(shapes::cube(), parse_input_kind("outliers:5"), kCount, 1);
  EXPECT_EQ(input.surface, kCount - kCount / 20);
  double largest = 0;
  for (std::size_t i = input.surface; i < kCount; ++i) largest = std::max(largest, std::fabs(input.points[i][0] - 0.5));
  EXPECT_GT(largest, 0.58);
  EXPECT_LE(largest, 0.6);
}

TEST(BenchInputs, GradientHasTheRatioOfDensitiesAtItsEnds) {
  const Input input = make_input(bar(), parse_input_kind("gradient:10"), kCount, 1);
  double low = 0, high = 0;
  for (const Vec3& p : input.points) {
    low += p[0] < 2.2 ? 1 : 0;
    high += p[0] > 3.8 ? 1 : 0;
  }
  EXPECT_NEAR(low / high, std::pow(10, 0.9), 0.8);  // tenths of the side, 0.9 sides apart
}

TEST(BenchInputs, StripesAreDenseAndSparseByTurns) {
  const Input input = make_input(bar(), parse_input_kind("pcpnet:stripes"), kCount, 1);
  std::array<double, 10> stripes{};
  for (const Vec3& p : input.points) {
    if (p[0] > 2 && p[0] < 4) ++stripes[static_cast<std::size_t>((p[0] - 2) / 0.2)];  // without the ends, which have a face more
  }
  for (std::size_t k = 0; k < 10; k += 2) EXPECT_NEAR(stripes[k] / stripes[k + 1], 10, 1.5) << k;
}

TEST(BenchInputs, PcpnetStandsForSixOf100000Points) {
  const std::vector<InputKind> kinds = parse_input_kinds({"clean", "pcpnet"});
  ASSERT_EQ(kinds.size(), 7u);
  EXPECT_EQ(kinds[0].points, 5000u);
  for (std::size_t k = 1; k < 7; ++k) {
    EXPECT_EQ(kinds[k].points, 100000u) << kinds[k].name;
    EXPECT_EQ(kinds[k].name.rfind("pcpnet:", 0), 0u) << kinds[k].name;
  }
  const Input gradient = make_input(bar(), parse_input_kind("pcpnet:gradient"), 1000, 1);
  EXPECT_EQ(gradient.points, make_input(bar(), parse_input_kind("gradient:10"), 1000, 1).points);
}

TEST(BenchInputs, PatchesAreEmpty) {
  const Input input = make_input(bar(), parse_input_kind("patches:3"), kCount, 1);
  const Input clean = make_input(bar(), parse_input_kind("clean"), kCount, 1);
  // Some clean points have no neighbour among the points of the patched input.
  std::size_t lonely = 0;
  for (std::size_t i = 0; i < 500; ++i) {
    const bool near = std::any_of(input.points.begin(), input.points.end(), [&](const Vec3& p) {
      const Vec3 d = vector::subtract(p, clean.points[i]);
      return vector::dot(d, d) < 0.07 * 0.07;
    });
    lonely += near ? 0 : 1;
  }
  EXPECT_GT(lonely, 0u);
  EXPECT_LT(lonely, 50u);
}

TEST(BenchInputs, ThinPartsFaceAnotherSideNearby) {
  const auto share = [](double thickness, const char* kind) {  // of a plate of 1 x 1, sampled at a spacing of 0.01
    Mesh plate = shapes::cube();
    for (Vec3& p : plate.vertices) p[2] *= thickness;
    const std::vector<bool> thin = make_input(plate, parse_input_kind(kind), kCount, 1).thin;
    return static_cast<double>(std::count(thin.begin(), thin.end(), true)) / static_cast<double>(thin.size());
  };
  EXPECT_GT(share(0.005, "clean"), 0.9);
  if (kSanitized) return;  // the others take 20 seconds
  EXPECT_EQ(share(0.2, "clean"), 0);
  EXPECT_NEAR(share(0.2, "noise:8"), 2 / 2.8, 0.02);  // 4 standard deviations are 0.46: both plates, not the rim
}

TEST(BenchInputs, UnknownKindsAreRefused) {
  for (const char* text : {"", "noise", "noise:", "noise:x", "noise:0", "noise:1%", "holes:3", "clean:1", "outliers:99", "gradient:nan",
                           "stripes:1", "pcpnet", "pcpnet:", "pcpnet:0.5"}) {
    EXPECT_THROW((void)parse_input_kind(text), InvalidInput) << text;
  }
}

TEST(BenchVariant, PresetAndOptionsAreRead) {
  const Variant variant = parse_variant(
      "paper;method=energy;epsilon=0.4h;noise=0;schedule=20 cg;degree=1;harmonics=1,x,y,z;solver=cg;tolerance=1e-3;mesher=field;depth=8");
  EXPECT_EQ(variant.options.preset, Preset::kPaper);
  EXPECT_EQ(variant.options.method, g3r::Method::kEnergy);
  EXPECT_EQ(variant.options.epsilon.unit, Length::Unit::kSpacing);
  EXPECT_EQ(variant.options.epsilon.value, 0.4);
  EXPECT_EQ(variant.options.noise.unit, Length::Unit::kInput);
  EXPECT_EQ(variant.options.schedule, "20 cg");
  EXPECT_EQ(variant.options.degree, 1);
  EXPECT_EQ(variant.options.harmonics, "1,x,y,z");
  EXPECT_EQ(variant.options.solver, Solver::kConjugateGradient);
  EXPECT_EQ(variant.options.tolerance, 1e-3);
  EXPECT_EQ(variant.mesh.depth, 8);
  EXPECT_EQ(variant.mesh.mesher, Mesher::kField);
  EXPECT_EQ(parse_variant("default").mesh.depth, 0);
}

TEST(BenchVariant, EarlierMethodsAreRead) {
  EXPECT_EQ(parse_variant("wnnc;widths=noise-0.5").options.method, g3r::Method::kWnnc);
  EXPECT_EQ(parse_variant("wnnc;widths=noise-0.5").options.wnnc_widths, "noise-0.5");
  EXPECT_EQ(parse_variant("agr").options.method, g3r::Method::kAgr);
  EXPECT_EQ(parse_variant("pgr;epsilon=0.5h").options.method, g3r::Method::kPgr);
}

TEST(BenchMeasure, TrueNormalsGoStraightToTheMesher) {
  const Variant variant = parse_variant("true;mesher=field");
  EXPECT_TRUE(variant.true_normals);
  const Mesh truth = shapes::sphere(1, 40);
  const InputKind kind = parse_input_kind("clean");
  const Input input = make_input(truth, kind, 1000, 1);
  const Row row = measure("sphere", truth, input, kind, variant, true, 1);
  ASSERT_TRUE(row.mesh.has_value()) << row.error << row.mesh_error;
  EXPECT_TRUE(row.mesh->check.closed);
  EXPECT_EQ(row.mesh->check.genus, 0);
  EXPECT_EQ(row.mesh->check.self_intersections, 0u);
  EXPECT_LT(row.mesh->chamfer, 0.02);
  EXPECT_FALSE(measure("sphere", truth, input, kind, variant, false, 1).error.empty());
}

// Points of two walls that are 2 s apart lie on their own side of the middle with the probability Phi(1), whoever looks at them, and one of
// a thick wall always does.
TEST(BenchMeasure, TheCeilingOfAPlateIsThatOfTwoNormalDistributions) {
  const InputKind kind = parse_input_kind("noise:0.5");
  for (const double walls : {2.0, 40.0}) {
    Mesh plate = shapes::cube();
    for (Vec3& p : plate.vertices) p[2] *= walls * 0.005 * std::sqrt(2.0);
    const Input input = make_input(plate, kind, 4000, 1);
    const Row row = measure("plate", plate, input, kind, parse_variant("ceiling"), false, 1);
    EXPECT_NEAR(row.pco, walls == 2 ? 0.8413 : 1, 0.02) << row.error;
    const Row ours = measure("plate", plate, input, kind, parse_variant("default"), false, 1);
    EXPECT_GT(ours.ae, row.ae * 0.97);
  }
  const InputKind clean = parse_input_kind("clean");
  const Mesh cube = shapes::cube();
  EXPECT_FALSE(measure("cube", cube, make_input(cube, clean, 100, 1), clean, parse_variant("ceiling"), false, 1).error.empty());
}

TEST(BenchVariant, MistakesAreRefused) {
  for (const char* text : {"", "best", "paper;degree", "paper;degree=x", "paper;colour=1", "default;epsilon=0.4y", "default;solver=lu"}) {
    EXPECT_THROW((void)parse_variant(text), InvalidInput) << text;
  }
}

TEST(BenchMeasure, AreaUnderCurveIsTheShareOfOrderedPairs) {
  EXPECT_EQ(area_under_curve({3, 4}, {1, 2}), 1);
  EXPECT_EQ(area_under_curve({1, 2}, {3, 4}), 0);
  EXPECT_EQ(area_under_curve({1, 1}, {1}), 0.5);
  EXPECT_EQ(area_under_curve({1, 3}, {2}), 0.5);
}

Row row(const char* model, const char* method, double ae) {
  Row r;
  r.model = model;
  r.input = "clean";
  r.method = method;
  r.points = 10;
  r.ae = ae;
  r.pco = 1;
  return r;
}

TEST(BenchResults, JsonHoldsEveryRow) {
  std::vector<Row> rows = {row("a", "paper", 0.25), row("b", "paper", 0.5)};
  rows[1].error = "no";
  rows[0].mesh.emplace();
  const auto json = nlohmann::json::parse(to_json({"label", 5, 2}, rows));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["seed"], 5);
  ASSERT_EQ(json["rows"].size(), 2u);
  EXPECT_EQ(json["rows"][0]["ae_p"], 0.25);
  EXPECT_EQ(json["rows"][0]["mesh"]["closed"], false);
  EXPECT_EQ(json["rows"][1]["error"], "no");
  EXPECT_FALSE(json["rows"][1].contains("ae_p"));
}

TEST(BenchResults, MarkdownNamesUnusableMeshes) {
  Row broken;
  broken.model = "flat";
  broken.error = "no area";
  const std::string text = to_markdown({"", 1, 0}, {broken, row("a", "paper", 0.01)});
  EXPECT_NE(text.find("Not measured: flat: no area\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("0 points"), text.find("10 points") + 1) << text;
}

TEST(BenchResults, MarkdownHasMeanMedianAndWorst) {
  const std::vector<Row> rows = {row("a", "paper", 0.01), row("b", "paper", 0.05), row("c", "paper", 0.03), row("d", "paper", 0.02)};
  const std::string text = to_markdown({"", 1, 0}, rows);
  EXPECT_NE(text.find("| paper | 4 | 2.750 | 2.500 | b 5.000, c 3.000, d 2.000 |"), std::string::npos) << text;
  EXPECT_NE(text.find("| a | 1.000 / 100.000 |"), std::string::npos) << text;
}

}  // namespace
}  // namespace g3r::bench
