// Names: every value has one word, every word one value.
#include <g3r/names.h>

#include <gtest/gtest.h>

#include <set>
#include <string_view>

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

}  // namespace
}  // namespace g3r
