// Texts with one point per line as people have them: columns with words, points with numbers, names of axes, quotes.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "io/column_facts.h"
#include "io/column_names.h"
#include "io/text_values.h"
#include "io_samples.h"

namespace g3r {
namespace {

using samples::message_of;
using samples::read;
using Names = std::vector<std::string>;

void expect_said(const std::vector<std::string>& warnings, const std::string& what) {
  for (const std::string& warning : warnings) {
    if (warning.find(what) != std::string::npos) return;
  }
  ADD_FAILURE() << "no warning says \"" << what << "\"";
}

std::string repeated(const std::string& line, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += line;
  return text;
}

TEST(Separator, CommasBetweenNumbersAreDistinguishedFromDecimalOnes) {
  EXPECT_EQ(io::separator_of("1,2,3"), ',');
  EXPECT_EQ(io::separator_of("1, 2, 3, big wall"), ',');
  EXPECT_EQ(io::separator_of("0,5 0,25 0,1"), ' ');
  EXPECT_EQ(io::separator_of("0,5;0,25;0,1"), ';');
  EXPECT_EQ(io::separator_of(R"("a; b",1,2,3)"), ',');
}

TEST(Values, QuotesHideSeparators) {
  io::Values values(R"("FENCE, 5"" WOOD", "1.5" ,x"y,"open,)", ',');
  std::string_view value;
  Names seen;
  while (values.next(value)) seen.emplace_back(value);
  EXPECT_EQ(seen, (Names{R"(FENCE, 5"" WOOD)", "1.5", "x\"y", "\"open"}));
}

TEST(TextColumns, AreLeftOutAndNamed) {
  const Cloud cloud = read("x,y,z,label,i\n1,2,3,wall,7\n4,5,6,big roof,8\n");
  EXPECT_EQ(cloud.positions[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(cloud.property_names, (Names{"x", "y", "z", "i"}));
  ASSERT_EQ(cloud.warnings.size(), 1U);
  expect_said(cloud.warnings, "4 \"label\" (\"wall\")");
  const Cloud labelled = read("label;x;y;z\nwall;1;2;3\n");
  EXPECT_EQ(labelled.positions[0], (Vec3{1, 2, 3}));
  const Cloud bare = read("1 2 3 0 0 1 a\n4 5 6 0 1 0 b\n");
  EXPECT_EQ(bare.normals[1], (Vec3{0, 1, 0}));
  expect_said(bare.warnings, "7 (\"a\")");
  expect_said(read("1 2 3" + repeated(" a", 20) + "\n").warnings, "and 12 more");
  EXPECT_EQ(read("x,y,z,a,i\n1,2,3,,4\n1,2,4,,4\n").property_names, (Names{"x", "y", "z", "i"}));  // nothing but missing values
}

TEST(TextColumns, AWordAmongNumbersIsDamage) {
  const std::string good = repeated("1 2 3 4\n", 300);
  EXPECT_NE(message_of(good + "1 2 3 x4\n" + good).find("line 301: expected a number, found \"x4\""), std::string::npos);
  EXPECT_NE(message_of("x,y,z,label\n1,2,3,wall\n1,north,3,wall\n").find("line 3: expected a number, found \"north\""), std::string::npos);
  EXPECT_NE(message_of("1 2 3 4\n1 north 3 4\n").find("line 2"), std::string::npos);
  EXPECT_NE(message_of("0,5;1,5;2,5;255;0;0\n").find("decimal comma"), std::string::npos);
}

TEST(Pnezd, IsRecognisedAndSaid) {
  const Cloud cloud = read("1,5000.5,1000.25,7.5,GND\n7,5001,1001,8,\"EP, \"\"N\"\"\"\n");
  EXPECT_EQ(cloud.positions[0], (Vec3{1000.25, 5000.5, 7.5}));
  EXPECT_EQ(cloud.property_names, (Names{"point", "y", "x", "z"}));
  expect_said(cloud.warnings, "PNEZD");
  EXPECT_EQ(read("A1 5000.5 1000.25 7.5 GND 1\n").positions[0], (Vec3{1000.25, 5000.5, 7.5}));
  EXPECT_EQ(read("5,6,7,1,wall\n5,7,7,1,wall\n").positions[1], (Vec3{5, 7, 7}));  // x is no number of a point: it occurs twice
}

TEST(AllDiffer, InAsManyPartsAsTheMemoryAsksFor) {
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) values.push_back(i * 7 % 500);
  const auto differ = [&](std::size_t at_once) {
    return io::all_differ(
        values.size(), [&](const auto& take) { std::for_each(values.begin(), values.end(), take); }, at_once);
  };
  for (const std::size_t at_once : {1U, 10U, 1000U}) {
    values[0] = 0;
    EXPECT_TRUE(differ(at_once));
    values[0] = values[321];
    EXPECT_FALSE(differ(at_once)) << at_once;
  }
  values = {0.0, -0.0};
  EXPECT_FALSE(differ(1));
}

TEST(Pnezd, NamedColumnsAreTakenAtTheirWord) {
  const Cloud cloud = read("Point,Northing,Easting,Elev,Desc\n1,5000.5,1000.25,7.5,GND\n");
  EXPECT_EQ(cloud.positions[0], (Vec3{1000.25, 5000.5, 7.5}));
  EXPECT_EQ(cloud.warnings.size(), 1U);  // of the description
  EXPECT_EQ(read("point,x,y,z,description\n1,5000.5,1000.25,7.5,GND\n").positions[0], (Vec3{5000.5, 1000.25, 7.5}));
}

TEST(Numbers, OfPointsAreNoCoordinates) {
  std::string numbered;
  for (int i = 1; i <= 12; ++i) numbered += std::to_string(i) + " 0.5 " + std::to_string(i % 3) + " 2\n";
  const Cloud cloud = read(numbered);
  EXPECT_EQ(cloud.positions[3], (Vec3{0.5, 1, 2}));
  expect_said(cloud.warnings, "point,northing,easting,elevation");
  EXPECT_EQ(read("12\n" + numbered).positions[3], (Vec3{4, 0.5, 1}));  // PTS begins with x
  EXPECT_EQ(read("P1 1.5 2 3\nP2 1 2 3\n").positions[0], (Vec3{1.5, 2, 3}));
}

TEST(HashHeader, NamesTheColumnsIfItNamesTheAxes) {
  const Cloud cloud = read("# made by hand\n# ID TIME LONGITUDE LATITUDE ELEVATION\n7 0.5 11.25 48.5 500\n");
  EXPECT_EQ(cloud.positions[0], (Vec3{11.25, 48.5, 500}));
  EXPECT_EQ(cloud.property_names, (Names{"ID", "TIME", "x", "y", "z"}));
  expect_said(cloud.warnings, "longitude and latitude");
  EXPECT_TRUE(read("# ID Lon Lat Height\n7 500000 5400000 500\n").warnings.empty());  // metres, whatever they are called
  EXPECT_EQ(read("# not names at all\n1 2 3 4\n").positions[0], (Vec3{1, 2, 3}));
}

TEST(Pts, MorePointsThanCountedAreReadAndSaid) {
  const Cloud cloud = read("2\n1 2 3\n4 5 6\n7 8 9\n");
  EXPECT_EQ(cloud.positions.size(), 3U);
  expect_said(cloud.warnings, "more points follow than the count line says (2)");
  EXPECT_NE(message_of("4\n1 2 3\n4 5 6\n7 8 9\n").find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace g3r
