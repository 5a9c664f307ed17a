// Names: every value has one word, every word one value; lengths and directions as texts; the bounds of options.
#include <g3r/names.h>

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string_view>
#include <vector>

namespace g3r {
namespace {

template <class Value>
class Names : public testing::Test {};
using Enumerations = testing::Types<Preset, Method, Solver, Mesher, MeshOptions::Trim, Length::Unit>;
TYPED_TEST_SUITE(Names, Enumerations);

TYPED_TEST(Names, AreReadBackAsTheValuesThatTheyName) {
  std::set<std::string_view> words;
  for (const auto& [word, value] : g3r::Names<TypeParam>::kAll) {
    EXPECT_EQ(name_of(value), word);
    EXPECT_EQ(parse<TypeParam>(word), value);
    EXPECT_TRUE(words.insert(word).second) << word;
  }
}

TYPED_TEST(Names, OfOthersAreNone) {
  for (const char* text : {"Auto", "auto ", " ", "green,energy", "\n"}) EXPECT_FALSE(parse<TypeParam>(text)) << text;
  EXPECT_EQ(name_of(static_cast<TypeParam>(99)), "");
}

TEST(NamesOf, ListsAllWithTheirQuotes) {
  EXPECT_EQ(words<Solver>(), "auto, dense, cg");
  EXPECT_EQ(words<Solver>("'"), "'auto', 'dense', 'cg'");
}

TEST(ParseLength, ReadsNumberAndUnit) {
  const auto is = [](std::string_view text, Length::Unit unit, double value) {
    const auto length = parse_length(text);
    return length && length->unit == unit && length->value == value;
  };
  EXPECT_TRUE(is("auto", Length::Unit::kAuto, 0));
  EXPECT_TRUE(is("2", Length::Unit::kInput, 2));
  EXPECT_TRUE(is("0", Length::Unit::kInput, 0));
  EXPECT_TRUE(is("0.5%", Length::Unit::kPercent, 0.5));
  EXPECT_TRUE(is("8e-1h", Length::Unit::kSpacing, 0.8));
  EXPECT_TRUE(is("1n", Length::Unit::kNormalised, 1));
}

TEST(ParseLength, RefusesWhatIsNone) {
  for (const char* text : {"", "h", "-1", "1 h", "1hh", "1m", "nan", "inf", "1e999", "+1", "0x1", "auto h", "1\n"}) {
    EXPECT_FALSE(parse_length(text)) << text;
  }
}

TEST(ParseDirection, TakesAxesAndThreeNumbersThatAreNotAllZero) {
  EXPECT_EQ(parse_direction("z"), (Vec3{0, 0, 1}));
  EXPECT_EQ(parse_direction("-y"), (Vec3{0, -1, 0}));
  EXPECT_EQ(parse_direction("+Z"), (Vec3{0, 0, 1}));
  EXPECT_EQ(parse_direction("-X"), (Vec3{-1, 0, 0}));
  EXPECT_EQ(parse_direction("1,-2.5,3e2"), (Vec3{1, -2.5, 300}));
  for (const char* text : {"", "+", "w", "zz", "+1", "0,0,0", "1,2", "1,2,3,", "1,2,3,4", "1, 2,3", "1,,3", "nan,0,0", "1e999,0,0"}) {
    EXPECT_FALSE(parse_direction(text)) << text;
  }
  EXPECT_EQ(parse_vector("0,0,0"), (Vec3{0, 0, 0}));
  EXPECT_FALSE(parse_vector("z"));
}

TEST(MeshOptions, OutOfRangeAreRefusedBeforeAnyWork) {
  const std::vector<Vec3> tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Monitor monitor;
  bool began = false;
  monitor.progress = [&](std::string_view, double) { return began = true; };
  std::vector<MeshOptions> bad(6);
  bad[0].depth = kLeastMeshDepth - 1;
  bad[1].depth = kMostMeshDepth + 1;
  bad[2].depth = -1;
  bad[3].trim = MeshOptions::Trim::kDistance;
  bad[4].trim = MeshOptions::Trim::kDistance;
  bad[4].trim_distance = std::numeric_limits<double>::infinity();
  bad[5].min_component = -1;
  for (const MeshOptions& options : bad) {
    EXPECT_THROW((void)reconstruct(tetrahedron, {}, options, monitor), InvalidInput);
    EXPECT_THROW((void)mesh_oriented(tetrahedron, tetrahedron, options, monitor), InvalidInput);
  }
  EXPECT_FALSE(began);
}

}  // namespace
}  // namespace g3r
