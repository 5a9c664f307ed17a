// Texts with one point per line as people have them: columns with words, points with numbers, names of axes, quotes.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

// A separator at the end of some lines, blanks where other lines have tabs, and points without a number are what hands and programs write.
TEST(TextColumns, OfUnevenLinesAreRead) {
  const Vec3 last{7, 8, 9};
  EXPECT_EQ(read("1,2,3,\n4,5,6,\n7,8,9\n").positions.back(), last);
  EXPECT_EQ(read("1\t2\t3\n7 8 9\n").positions.back(), last);
  EXPECT_EQ(read("1\t2\t3\n7\t\t8\t9\n").positions.back(), last);
  const Cloud gap = read("id,x,y,z\nP1,1,,3\nP2,7,8,9\n", "a.csv");
  ASSERT_EQ(gap.positions.size(), 2U);
  EXPECT_TRUE(std::isnan(gap.positions[0][1]));
  EXPECT_EQ(gap.positions[1], last);
}

// What a warning calls x, y and z is what is taken.
TEST(TextColumns, TakenForAxesAreThoseThatTheWarningNames) {
  const Cloud cloud = read("x,POINT_X,POINT_Y,POINT_Z\n9,1,2,3\n9,4,5,6\n");
  expect_said(cloud.warnings, "\"POINT_X\", \"POINT_Y\" and \"POINT_Z\" are taken for them");
  EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 3}));
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

TEST(MissingNumbers, AreNanAndSaid) {
  const Cloud last = read("x,y,z,i\n1,2,3,4\n1,2,4,\n1,2,5,\n");
  EXPECT_EQ(last.property_names, (Names{"x", "y", "z", "i"}));
  EXPECT_EQ(last.positions.size(), 3U);
  expect_said(last.warnings, "column 4 \"i\" has no number in 2 lines, first in line 3");
  EXPECT_EQ(read("x,y,z,i\n1,2,4,\n1,2,3,4\n").property_names.size(), 4U);  // the first line ends with the empty cell
  EXPECT_EQ(read("1,2,4,\n1,2,3,4\n").property_names.size(), 4U);
  EXPECT_EQ(read("1,2,4,\n1,2,3,\n").property_names.size(), 3U);  // a separator ends each line
  EXPECT_EQ(read("1;2;;7\n1;2;3;8\n").property_names.size(), 4U);
  const Cloud words = read("x y z i\n1 2 3 NA\n1 2 null 5\n1 2 4 n/a\n");
  EXPECT_TRUE(std::isnan(words.positions[1][2]));
  expect_said(words.warnings, "column 3 \"z\" has no number in one line, first in line 3");
  const Cloud bare = read("1,2,3\n1,,4\n1,2,5\n");
  EXPECT_TRUE(std::isnan(bare.positions[1][1]));
  expect_said(bare.warnings, "column 2 has no number in one line");
  EXPECT_NE(message_of("x,y,z\n1,2,\n3,4,\n").find("expected a coordinate in column 3 \"z\""), std::string::npos);
  EXPECT_NE(message_of("1,2,3,4\n1,2,3\n").find("line 2: expected 4 columns as on the lines before, found 3 (also an empty cell"),
            std::string::npos);
}

TEST(Words, InColumnsOfNumbersAreSaidWithTheColumn) {
  EXPECT_NE(message_of("x,y,z\n1,2,3\n1,2,abc\n").find("line 3: expected a number, found \"abc\" in column 3 \"z\""), std::string::npos);
  EXPECT_NE(message_of("1 2 3\n1 abc 3\n").find("line 2: expected a number, found \"abc\" in column 2"), std::string::npos);
}

TEST(Tabs, SeparateWordsWithBlanksAndEmptyCells) {
  const Cloud cloud = read("ID\tX\tY\tZ\tnote\ti\n1\t1.5\t2\t3\t\"a, b\"\t5\n2\t1.5\t2\t4\tbig wall\t6\n3\t1.5\t2\t5\t\t7\n");
  EXPECT_EQ(cloud.positions[2], (Vec3{1.5, 2, 5}));
  EXPECT_EQ(cloud.property_names, (Names{"ID", "x", "y", "z", "i"}));
  EXPECT_EQ(io::separator_of("1\t\t2\t\t3"), ' ');
  EXPECT_EQ(io::separator_of("1\t2 3\t4\t5"), ' ');
  EXPECT_EQ(io::separator_of("1,\t2,\t3"), ',');
}

TEST(HeaderLines, OfAnyNumberMayComeFirst) {
  const Cloud cloud = read("Project: Bridge 7\nDate: today, operator: me\nx,y,z,i\n[m],[m],[m],[-]\n1,2,3,4\n", "a.csv");
  EXPECT_EQ(cloud.property_names, (Names{"x", "y", "z", "i"}));
  expect_said(cloud.warnings, "3 lines before the points, line 1 \"Project: Bridge 7\" the first, not used");
  EXPECT_EQ(read("made by hand\nP N E H code\nP1 2 1 3 wall\n", "a.txt").positions[0], (Vec3{1, 2, 3}));
  EXPECT_THROW((void)read("Project: Bridge 7\nx,y,z,i\n1,2,3,4\n", "a.ply"), InvalidInput);  // a PLY whose header is damaged
  std::string many;
  for (int i = 0; i < 30; ++i) many += "a line of words\n";
  EXPECT_THROW((void)read(many + "1 2 3\n", "a.txt"), InvalidInput);
}

TEST(Names, AreOursOnlyWhereAllThreeAreThere) {
  const auto names = [](const std::string& header, const std::string& row) { return read(header + "\n" + row + "\n").property_names; };
  EXPECT_EQ(names("x,y,z,b", "1,2,3,4"), (Names{"x", "y", "z", "b"}));
  EXPECT_EQ(names("x,y,z,Red", "1,2,3,4"), (Names{"x", "y", "z", "Red"}));
  EXPECT_EQ(names("R,G,B,X,Y,Z", "1,2,3,4,5,6"), (Names{"red", "green", "blue", "x", "y", "z"}));
  EXPECT_EQ(names("x,y,z,n_x,n_y,n_z", "1,2,3,4,5,6"), (Names{"x", "y", "z", "nx", "ny", "nz"}));
  EXPECT_EQ(names("x,y,z,i,j,k", "1,2,3,0,0,1"), (Names{"x", "y", "z", "nx", "ny", "nz"}));  // of length 1
  EXPECT_EQ(names("x,y,z,i,j,k", "1,2,3,4,5,6"), (Names{"x", "y", "z", "i", "j", "k"}));
  EXPECT_EQ(names("x,y,z,id,label", "1,2,3,4,5"), (Names{"x", "y", "z", "id", "label"}));
  EXPECT_EQ(names("x,y,n", "1,2,3"), (Names{"x", "y", "z"}));  // the first three, with a warning
}

TEST(Names, HaveUnitsBehindBlanks) {
  const std::string row = "5000 1000 3 7\n";
  for (const char* header :
       {"# Northing [m] Easting [m] Height [m] i [1]", "Northing (m) Easting (m) Height (m) i", "N[m]\tE [ m ] H [m] i"}) {
    const Cloud cloud = read(header + ("\n" + row), "a.txt");
    EXPECT_EQ(cloud.positions[0], (Vec3{1000, 5000, 3})) << header;
    EXPECT_TRUE(cloud.warnings.empty()) << header;
  }
  EXPECT_EQ(read("# z y x [m]\n3 2 1\n").positions[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(read("# x y z (a) [b]\n1 2 3 4 5\n").property_names[3], "(a)");  // names of their own, where the columns ask for it
}

TEST(Names, MayBeSeparatedByCommasWherePointsAreByBlanks) {
  for (const char* header : {"# y, x, z, t", "y, x, z, t", "# y; x; z; t", "#y,x,z,t"}) {
    const Cloud cloud = read(header + std::string("\n5000 1000 3 7\n"), "a.txt");  // as numpy.savetxt() writes
    EXPECT_EQ(cloud.positions[0], (Vec3{1000, 5000, 3})) << header;
    EXPECT_EQ(cloud.property_names[3], "t") << header;
  }
}

TEST(Names, OfAxesAreFoundWhereverTheyStand) {
  EXPECT_EQ(read("P,N,E,H\n7,5000,1000,3\n").positions[0], (Vec3{1000, 5000, 3}));
  EXPECT_EQ(read("t,e,n,u\n7,1000,5000,3\n").positions[0], (Vec3{1000, 5000, 3}));
  for (const char* header :
       {"id,POINT_X,POINT_Y,POINT_Z", "id,Points:0,Points:1,Points:2", "id,x_m,y_m,z_m", "id,field.x,field.y,field.z"}) {
    const Cloud cloud = read(std::string(header) + "\n7,1,2,3\n");
    EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 3})) << header;
    expect_said(cloud.warnings, "are taken for them");
  }
  const Cloud latin = read("Nr;Rechtswert;Hochwert;H\xf6he \xfc.NN;Code\n7;1000;5000;3;8\n");  // two are known, the next is the third
  EXPECT_EQ(latin.positions[0], (Vec3{1000, 5000, 3}));
  expect_said(latin.warnings, "are taken for them");
  EXPECT_EQ(read("nx,ny,nz,p_x,p_y,p_z\n0,0,1,1,2,3\n").positions[0], (Vec3{1, 2, 3}));
}

TEST(Order, OfColumnsWithoutNamesIsDoubtedWhereItLooksOdd) {
  expect_said(read("255 0 7 1.5 2 3\n1 2 3 1.5 2 4\n").warnings, "look like colours");
  expect_said(read("255 0 7 255 1.5 2 3\n1 2 3 255 1.5 2 4\n").warnings, "look like colours");
  expect_said(read("0.6 0.8 0 1.5 2 3\n0 1 0 1.5 2 4\n").warnings, "look like normals");
  expect_said(read("12 1.5 2.5 3.5\n12 1.5 2.5 4.5\n").warnings, "intensity,x,y,z");
  for (const char* usual : {"1.5 2 3 255 0 7\n", "0 0 1 255 0 7\n", "1 2 3 0 0 1\n", "10 2 3 4 5 6\n"})
    EXPECT_TRUE(read(usual).warnings.empty()) << usual;
}

// Normals are no whole numbers above 1.
TEST(Order, OfThreeWholeNumbersIsThatOfColours) {
  const Cloud deep = read("1 2 3 40000 300 0\n4 5 6 65535 0 257\n");
  EXPECT_EQ(deep.property_names, (Names{"x", "y", "z", "red", "green", "blue"}));
  EXPECT_EQ(deep.colors[1], (std::array<std::uint8_t, 3>{255, 0, 1}));
  expect_said(deep.warnings, "columns 4 to 6 are taken for red, green and blue of 16 bits");
  EXPECT_EQ(read("1 2 3 70000 300 0\n").property_names, (Names{"x", "y", "z", "scalar_4", "scalar_5", "scalar_6"}));
  EXPECT_EQ(read("1 2 3 -400 300 0\n").normals.size(), 1U);
  EXPECT_EQ(read("1 2 3 0 0 1\n1 2 4 0 1 0\n").normals.size(), 2U);
}

TEST(Pts, HasTheIntensityBeforeTheColours) {
  const std::string rows = "1.5 2 3 200 10 20 30\n4.5 5 6 7 11 21 31\n";
  const Cloud counted = read("2\n" + rows);
  EXPECT_EQ(counted.property_names, (Names{"x", "y", "z", "intensity", "red", "green", "blue"}));
  EXPECT_EQ(counted.colors[0], (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_TRUE(counted.warnings.empty());
  const Cloud bare = read(rows);
  EXPECT_EQ(bare.property_names, (Names{"x", "y", "z", "red", "green", "blue", "scalar_7"}));
  expect_said(bare.warnings, "x,y,z,intensity,red,green,blue");
  EXPECT_EQ(read("1\n1 2 3 -500.5 10 20 30 0 0 1\n").property_names,
            (Names{"x", "y", "z", "intensity", "red", "green", "blue", "nx", "ny", "nz"}));
  EXPECT_EQ(read("1\n1 2 3 10 20 30 0 0 1\n").property_names, (Names{"x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"}));
  EXPECT_EQ(read("1\n1 2 3 0 0 1 9\n").property_names, (Names{"x", "y", "z", "nx", "ny", "nz", "scalar_7"}));
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
