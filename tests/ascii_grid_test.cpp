// ASCII grids of Arc/Info: one point for every cell that has a value, in its middle.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "io_samples.h"
#include "stream_checks.h"

namespace g3r {
namespace {

using samples::Folder;
using samples::message_of;
using samples::read;
using samples::spill;

const std::string kCorner = "ncols 3\nnrows 2\nxllcorner 500000.5\nyllcorner 4600000\ncellsize 0.25\n";
const std::string kValues = "1 2 3\n4 5 6\n";
const std::vector<Vec3> kCells = {{500000.625, 4600000.375, 1}, {500000.875, 4600000.375, 2}, {500001.125, 4600000.375, 3},
                                  {500000.625, 4600000.125, 4}, {500000.875, 4600000.125, 5}, {500001.125, 4600000.125, 6}};

std::string with(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

bool says(const std::string& text, const std::string& what) {
  const bool found = message_of(text).find(what) != std::string::npos;
  if (!found) ADD_FAILURE() << message_of(text);
  return found;
}

TEST(AsciiGrid, CellsArePointsInTheirMiddlesFromTheNorthWest) {
  const Cloud cloud = read(kCorner + kValues);
  EXPECT_EQ(cloud.format, "ascii grid");
  EXPECT_EQ(cloud.scalar, Scalar::kFloat64);
  EXPECT_EQ(cloud.positions, kCells);
  EXPECT_EQ(cloud.property_names, (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_TRUE(cloud.warnings.empty());
}

TEST(AsciiGrid, CentersAreMiddlesOfTheFirstCell) {
  const std::string west = with(kCorner, "xllcorner 500000.5", "xllcenter 500000.625");
  EXPECT_EQ(read(west + kValues).positions, kCells);
  EXPECT_EQ(read(with(west, "yllcorner 4600000", "yllcenter 4600000.125") + kValues).positions, kCells);
}

TEST(AsciiGrid, KeysStandInAnyOrderAndCase) {
  EXPECT_EQ(read("\xef\xbb\xbf"
                 "CellSize 0.25\r\nYLLCORNER\t4600000\r\n\r\nXLLCORNER 500000.5\r\nNROWS 2\r\n NCOLS   3\r\n1 2 3\r\n4 5 6\r\n")
                .positions,
            kCells);
  EXPECT_EQ(read("yllcorner 4600000\nnodata_value -1\ndy 0.25\ndx 0.25\nxllcorner 500000.5\nnrows 2\nncols 3\n" + kValues).positions,
            kCells);
}

TEST(AsciiGrid, CellsNeedNotBeSquare) {
  const Cloud cloud = read(with(kCorner, "cellsize 0.25", "dx 2\ndy 4") + kValues);
  EXPECT_EQ(cloud.positions.front(), (Vec3{500001.5, 4600006, 1}));
  EXPECT_EQ(cloud.positions.back(), (Vec3{500005.5, 4600002, 6}));
}

TEST(AsciiGrid, RowsAreBrokenIntoLinesAnyhow) {
  EXPECT_EQ(read(kCorner + "1 2 3 4 5 6\n").positions, kCells);
  EXPECT_EQ(read(kCorner + "1\n2\n\n3\n4 5\n6\n").positions, kCells);
  EXPECT_EQ(read(kCorner + " 1\t2 3 \r4 5 6\r\n\n").positions, kCells);
}

TEST(AsciiGrid, CellsWithoutAValueAreLeftOut) {
  const std::vector<Vec3> some = {kCells[0], kCells[3], kCells[4]};
  EXPECT_EQ(read(kCorner + "1 -9999 nan\n4 5 -9999.0\n").positions, some);  // -9999 where nothing else is said
  EXPECT_EQ(read(kCorner + "NODATA_value 0\n1 0 0.000\n4 5 0e9\n").positions, some);
  EXPECT_EQ(read(kCorner + "NODATA_value nan\n1 nan nan\n4 5 NaN\n").positions, some);
  EXPECT_EQ(read(kCorner + "NODATA_value -inf\n1 -inf -inf\n4 5 -inf\n").positions, some);
  // float32 with other digits
  EXPECT_EQ(read(kCorner + "NODATA_value -3.4028234663852886e+38\n1 -3.40282346638529e+38 -3.4028234e+38\n4 5 -3.4028235e+38\n").positions,
            some);
  EXPECT_EQ(read(kCorner + "1 -9999 -9998.9\n4 5 6\n").positions.size(), 5U);
}

TEST(AsciiGrid, AUsualNoDataThatIsNotDeclaredIsAWarning) {
  const Cloud cloud = read(kCorner + "NODATA_value -9989\n1 -9999 3\n4 5 -9999\n");
  EXPECT_EQ(cloud.positions.size(), 6U);
  ASSERT_EQ(cloud.warnings.size(), 1U);
  EXPECT_NE(cloud.warnings[0].find("-9999 is the value of 2 cells, but NODATA_value is -9989"), std::string::npos) << cloud.warnings[0];
}

TEST(AsciiGrid, WithoutAnyValueIsNoPointsAndAWarning) {
  const Cloud cloud = read(kCorner + "-9999 -9999 nan\n-9999 -9999 -9999\n");
  EXPECT_TRUE(cloud.positions.empty());
  ASSERT_EQ(cloud.warnings.size(), 1U);
  EXPECT_NE(cloud.warnings[0].find("no points: all of 3 x 2 values"), std::string::npos) << cloud.warnings[0];
}

TEST(AsciiGrid, OddValuesAreWarnings) {
  EXPECT_EQ(read(kCorner + "1 2 3 4 5 6").warnings.size(), 1U);  // no line end
  const Cloud cloud = read(kCorner + "1 2 1e999\n4 5 6\n");
  EXPECT_EQ(cloud.positions.size(), 6U);
  EXPECT_EQ(cloud.warnings.size(), 1U);
}

TEST(AsciiGrid, WhatIsWrongInTheHeaderIsSaid) {
  for (const char* line : {"ncols 3\n", "nrows 2\n", "xllcorner 500000.5\n", "yllcorner 4600000\n", "cellsize 0.25\n"}) {
    const std::string key(line, std::string(line).find(' '));
    EXPECT_TRUE(says(with(kCorner, line, "") + kValues, "sample: line 5: expected " + key)) << line;
  }
  EXPECT_TRUE(says(with(kCorner, "0.25", "0") + kValues, "line 5: expected a cellsize above 0, found \"0\""));
  EXPECT_TRUE(says(with(kCorner, "0.25", "-1") + kValues, "above 0"));
  EXPECT_TRUE(says(with(kCorner, "0.25", "0,25") + kValues, "decimal comma"));
  EXPECT_TRUE(says(with(kCorner, "4600000", "inf") + kValues, "line 4: expected a finite yllcorner"));
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ncols 0") + kValues, "line 1: expected ncols of at least 1"));
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ncols -3") + kValues, "negative"));
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ncols 3.5") + kValues, "not a whole number"));
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ncols") + kValues, "line 1: expected the columns of the grid (ncols)"));
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ncols 3 3") + kValues, "expected one number after ncols, found more: \"3\""));
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ocols 3") + kValues, "line 1: expected a key of the grid's header"));
  EXPECT_TRUE(says(kCorner + "xllcenter 0\n" + kValues, "line 6: expected each key once"));
  EXPECT_TRUE(says(kCorner, "truncated: no values"));
}

TEST(AsciiGrid, WhatIsWrongInTheValuesIsSaid) {
  EXPECT_TRUE(says(kCorner + "1.5 2 3\n4 5.5\n", "line 7: truncated: unexpected end of file after 5 of 3 x 2 values"));
  EXPECT_TRUE(says(kCorner + kValues + "7\n", "line 8: expected the end of the file after 3 x 2 values (ncols x nrows), found \"7\""));
  EXPECT_TRUE(says(kCorner + "1 2 3\n4 sea 6\n", "line 7: expected a number, found \"sea\""));
  EXPECT_TRUE(says(kCorner + "1 2 3\n4 5,5 6\n", "decimal comma"));
}

TEST(AsciiGrid, CountsBeyondTheFileAreRefused) {
  EXPECT_TRUE(says(with(kCorner, "ncols 3", "ncols 7") + kValues, "line 6: truncated: 7 x 2 values"));
  const std::string many = with(with(kCorner, "ncols 3", "ncols 4294967296"), "nrows 2", "nrows 4294967296");  // 2^64 wraps to 0
  EXPECT_TRUE(says(many + kValues, "count too large"));
  EXPECT_TRUE(says(with(kCorner, "nrows 2", "nrows 99999999999999999999") + kValues, "out of range"));
}

TEST(AsciiGrid, OtherTextsAreReadAsBefore) {
  EXPECT_EQ(read("ncols 3\n1 2 3\n4 5 6\n", "a.asc").positions.size(), 2U);  // one key is no header
  EXPECT_EQ(read("dx dy dz\n1 2 3\n", "a.asc").format, "xyz");
  EXPECT_EQ(read("project grid\ncellsize 5\n1 2 3\n", "a.asc").format, "xyz");
}

TEST(AsciiGrid, SurferGridsAreNamed) {
  for (const char* magic : {"DSAA\r\n3 2\n", "DSBB", "DSRB"}) EXPECT_TRUE(says(magic, "Surfer"));
}

TEST(AsciiGrid, FoldersOfThemAreOneCloud) {
  const Folder folder;
  spill(folder.path("1.asc"), kCorner + kValues);
  spill(folder.path("2.asc"), with(kCorner, "xllcorner 500000.5", "xllcorner 500001.25") + kValues);
  spill(folder.path("sea.asc"), kCorner + "-9999 -9999 -9999\n-9999 -9999 -9999\n");
  const Cloud cloud = read_cloud(folder.path(""));
  EXPECT_EQ(cloud.format, "3 files of ascii grid");
  EXPECT_EQ(cloud.positions.size(), 12U);
  EXPECT_EQ(cloud.positions[6], (Vec3{500001.375, 4600000.375, 1}));
  EXPECT_EQ(cloud.warnings.size(), 1U);
}

TEST(AsciiGrid, StreamsWarnOfWhatTheWholeFileDoes) {
  const Folder folder;
  for (const std::string values : {"1 2 3\n4 5 1e999", "-9999 nan nan\n-9999 nan nan", "NODATA_value 1\n1 1 1\n-9999 1 1\n"}) {
    spill(folder.path("a.asc"), "\xef\xbb\xbf" + kCorner + values);
    stream_checks::expect_what_read_cloud_gives(folder.path("a.asc"));
    EXPECT_EQ(io::open_points(folder.path("a.asc"))->warnings(), read_cloud(folder.path("a.asc")).warnings);
  }
}

}  // namespace
}  // namespace g3r
