// New LAS files: properties become the fields of LAS where they fit, coordinates keep their decimals.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "io/decimal_steps.h"
#include "io/las_fields.h"
#include "io_samples.h"

namespace g3r {
namespace {

using samples::read;

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// A LAS file of a text, and what its writer warned of.
struct WrittenLas {
  explicit WrittenLas(const std::string& text, const std::string& name = "a.csv") {
    const samples::Folder folder;
    const std::string path = folder.path("a.las");
    WriteOptions options;
    options.warnings = &warnings;
    write_cloud(path, read(text, name), nullptr, nullptr, options);
    bytes = samples::slurp(path);
    points_at = number_at<std::uint32_t>(bytes, 96);
    record = number_at<std::uint16_t>(bytes, 105);
    format = static_cast<unsigned char>(bytes[104]);
  }
  template <class T>
  [[nodiscard]] T field(std::size_t point, std::size_t offset) const {
    return number_at<T>(bytes, points_at + point * record + offset);
  }
  std::string bytes;
  std::vector<std::string> warnings;
  std::size_t points_at = 0;
  std::size_t record = 0;
  unsigned format = 0;
};

// Far from 0 as well: the offset taken off first would round twice.
TEST(DecimalSteps, OfAValueAreThoseThatGiveIt) {
  const io::DecimalSteps steps(1e-9, 5000000.498);
  for (int k = -1000; k < 1000; ++k) {
    const double count = 1000003.0 * k;
    EXPECT_EQ(steps.steps(steps.value(count)), count);
  }
}

TEST(LasFields, AreNamedInManyWays) {
  for (const char* name : {"gps_time", "GpsTime", "GPS time", "scalar_Gps_Time", "gpstime"})
    EXPECT_EQ(io::las_part(name), io::LasPart::kGpsTime) << name;
  EXPECT_EQ(io::las_part("scan_angle_rank"), io::LasPart::kScanAngle);
  for (const char* name : {"label", "gps", "intensity_2", "scalar"}) EXPECT_EQ(io::las_part(name), io::LasPart::kNone) << name;
}

TEST(NewLas, NumbersThatFitBecomeFields) {
  const WrittenLas las(
      "x,y,z,Intensity,classification,return_number,number_of_returns,GpsTime,red,green,blue,user_data,point_source_id,scan_angle\n"
      "0,0,0,65535,31,2,3,400000000.25,65535,300,0,7,4000,-12\n"
      "1,0,0,0,2,1,1,400000001.5,0,0,0,255,1,90\n");
  EXPECT_TRUE(las.warnings.empty()) << las.warnings[0];
  EXPECT_EQ(las.format, 3U);
  EXPECT_EQ(las.record, 34U) << "no extra bytes";
  EXPECT_EQ(las.field<std::uint16_t>(0, 12), 65535);
  EXPECT_EQ(las.field<std::uint8_t>(0, 14), 2 + 8 * 3);
  EXPECT_EQ(las.field<std::uint8_t>(0, 15), 31);
  EXPECT_EQ(las.field<std::int8_t>(0, 16), -12);
  EXPECT_EQ(las.field<std::uint8_t>(1, 17), 255);
  EXPECT_EQ(las.field<std::uint16_t>(0, 18), 4000);
  EXPECT_EQ(las.field<double>(0, 20), 400000000.25);
  EXPECT_EQ(las.field<std::uint16_t>(0, 28), 65535) << "16 bits are kept";
  EXPECT_EQ(las.field<std::uint16_t>(0, 30), 300);
  EXPECT_EQ(number_at<std::uint16_t>(las.bytes, 6), 1) << "times beyond a week are absolute";
  EXPECT_EQ(number_at<std::uint64_t>(las.bytes, 247 + 8 * 2), 1U) << "one second return";
}

TEST(NewLas, NumbersThatOnlyNewPointFormatsHoldAskForOne) {
  const WrittenLas las("x,y,z,classification,return_number,nir\n0,0,0,64,9,5\n1,0,0,2,1,6\n");
  EXPECT_TRUE(las.warnings.empty()) << las.warnings[0];
  EXPECT_EQ(las.format, 8U);
  EXPECT_EQ(las.field<std::uint8_t>(0, 14), 9 + 16 * 9) << "of at least as many returns";
  EXPECT_EQ(las.field<std::uint8_t>(0, 16), 64);
  EXPECT_EQ(las.field<std::uint16_t>(1, 36), 6);
  EXPECT_EQ(number_at<std::uint32_t>(las.bytes, 107), 0U) << "the counts of old formats are 0";
  EXPECT_EQ(number_at<std::uint16_t>(las.bytes, 6) & 16, 16) << "the bit that these formats need";
  EXPECT_TRUE(read(las.bytes).warnings.empty());
}

TEST(NewLas, FlagsBecomeBits) {
  const WrittenLas old("x,y,z,classification,synthetic,key_point,withheld\n0,0,0,2,1,0,1\n1,0,0,2,0,1,0\n");
  EXPECT_TRUE(old.warnings.empty()) << old.warnings[0];
  EXPECT_EQ(old.format, 0U);
  EXPECT_EQ(old.field<std::uint8_t>(0, 15), 2 + 32 + 128);
  EXPECT_EQ(old.field<std::uint8_t>(1, 15), 2 + 64);
  const WrittenLas extended("x,y,z,synthetic,key_point,withheld,overlap,scanner_channel\n0,0,0,1,0,1,1,2\n1,0,0,0,1,0,0,3\n");
  EXPECT_TRUE(extended.warnings.empty()) << extended.warnings[0];
  EXPECT_EQ(extended.format, 6U);
  EXPECT_EQ(extended.field<std::uint8_t>(0, 15), 1 + 4 + 8 + 16 * 2);
  EXPECT_EQ(extended.field<std::uint8_t>(1, 15), 2 + 16 * 3);
}

TEST(NewLas, NumbersThatDoNotFitAreExtraBytesAndSaidSo) {
  for (const auto& [name, value] : {std::pair<const char*, const char*>{"intensity", "0.25"},
                                    {"classification", "300"},
                                    {"return_number", "-1"},
                                    {"user_data", "nan"},
                                    {"scan_angle", "12.5"},
                                    {"gps_time", "nan"}}) {
    const WrittenLas las("x,y,z," + std::string(name) + "\n0,0,0,1\n1,0,0," + value + "\n");
    ASSERT_EQ(las.warnings.size(), 1U) << name;
    EXPECT_NE(las.warnings[0].find("\"" + std::string(name) + "\" becomes extra bytes \"" + name + "_2\""), std::string::npos)
        << las.warnings[0];
    const Cloud again = read(las.bytes);
    EXPECT_NE(std::find(again.property_names.begin(), again.property_names.end(), std::string(name) + "_2"), again.property_names.end());
  }
}

TEST(NewLas, BytesOfSeveralFieldsComeBackAsTheyWere) {
  // What g3r calls the bytes of LAS files of old and of new formats, as it writes them to a text.
  const WrittenLas first("x,y,z,return_flags,classification\n0,0,0,153,66\n1,0,0,9,2\n");
  EXPECT_TRUE(first.warnings.empty());
  EXPECT_EQ(first.format, 0U);
  EXPECT_EQ(first.field<std::uint8_t>(0, 14), 153);
  EXPECT_EQ(first.field<std::uint8_t>(0, 15), 66) << "class 2, key point";
  const WrittenLas second("x,y,z,return_numbers,return_flags,classification,scan_angle\n0,0,0,33,8,70,-3000\n1,0,0,17,0,2,3000\n");
  EXPECT_TRUE(second.warnings.empty());
  EXPECT_EQ(second.format, 6U);
  EXPECT_EQ(second.field<std::uint8_t>(0, 14), 33);
  EXPECT_EQ(second.field<std::uint8_t>(0, 15), 8);
  EXPECT_EQ(second.field<std::int16_t>(0, 18), -3000);
  const WrittenLas mixed("x,y,z,return_numbers,return_flags\n0,0,0,17,0\n1,0,0,0,9\n");
  ASSERT_EQ(mixed.warnings.size(), 1U) << "the flags of both formats mean different things";
  EXPECT_EQ(mixed.field<std::uint8_t>(1, 15), 0);
}

// Of files of new formats whose writer knew of no returns: the flags are a scan direction and an edge, a synthetic point, a channel.
TEST(NewLas, PointsOfNewFormatsThatNumberNoReturnKeepTheirFlags) {
  const WrittenLas las("x,y,z,return_numbers,return_flags\n0,0,0,0,192\n1,0,0,0,1\n2,0,0,0,16\n3,0,0,0,0\n");
  EXPECT_TRUE(las.warnings.empty()) << las.warnings[0];
  EXPECT_EQ(las.format, 6U);
  EXPECT_EQ(las.field<std::uint8_t>(0, 15), 192);
  EXPECT_EQ(las.field<std::uint8_t>(2, 15), 16);
  for (const char* other : {"0,9", "17,0"}) {  // a return of an old format; a point of a writer that knew of them
    const WrittenLas mixed("x,y,z,return_numbers,return_flags\n0,0,0,0,1\n1,0,0," + std::string(other) + "\n");
    EXPECT_EQ(mixed.warnings.size(), 1U) << other;
  }
}

TEST(NewLas, CoordinatesKeepTheirDecimals) {
  for (const char* text :
       {"36.354 86.43 -34.76\n-79.057 54.924 27.08\n", "500363.537 5000864.299 447.6026\n499209.429 5000549.242 370.7968\n",
        "0.018177 0.043215 0.01738\n-0.039529 0.027462 0.01354\n", "3000000.001 3000000.002 0\n3000000.003 3000000.004 1\n",
        "1 2 3\n4 5 6\n"}) {
    const WrittenLas las(text, "a.xyz");
    EXPECT_TRUE(las.warnings.empty()) << text << las.warnings[0];
    const Cloud cloud = read(las.bytes);
    EXPECT_EQ(cloud.positions, read(text, "a.xyz").positions) << text;
    std::string again = samples::written(read(samples::written(read(text, "a.xyz"), "a.las")), "a.xyz");
    again.erase(0, again.find('\n') + 1);
    EXPECT_EQ(again.substr(0, again.find(' ')), std::string(text).substr(0, std::string(text).find(' '))) << "the same digits";
  }
  const WrittenLas las("36.354 86.43 -34.76\n-79.057 54.924 27.08\n", "a.xyz");
  EXPECT_EQ(number_at<double>(las.bytes, 131), 0.001);
  EXPECT_EQ(number_at<double>(las.bytes, 155), 0);
}

TEST(NewLas, CoordinatesThatNeedMoreDigitsAreRoundedAndSaidSo) {
  const WrittenLas las("0.123456789 0 0\n5000000 1 1\n", "a.xyz");
  ASSERT_EQ(las.warnings.size(), 1U);
  EXPECT_NE(las.warnings[0].find("rounded (x to 0.01)"), std::string::npos) << las.warnings[0];
  EXPECT_NEAR(read(las.bytes).positions[0][0], 0.123456789, 0.005);
  // What a float does not hold cannot be lost.
  Cloud cloud = samples::helix(30, Scalar::kFloat32);
  std::vector<std::string> warnings;
  const samples::Folder folder;
  WriteOptions options;
  options.warnings = &warnings;
  write_cloud(folder.path("a.las"), cloud, nullptr, nullptr, options);
  EXPECT_TRUE(warnings.empty());
}

TEST(DecimalSteps, AreTheNearestDoublesOfDecimalNumbers) {
  EXPECT_EQ(io::DecimalSteps(0.001).value(86064), 86.064);
  EXPECT_NE(86064 * 0.001, 86.064) << "what it is for";
  EXPECT_EQ(io::DecimalSteps(0.01, 500000).value(12345), 500123.45);
  EXPECT_EQ(io::DecimalSteps(0.25, 0.1).value(3), 3 * 0.25 + 0.1) << "no power of ten";
  EXPECT_EQ(io::DecimalSteps(0.1, 0.05).value(3), 3 * 0.1 + 0.05) << "no whole number of steps";
}

TEST(Decimals, AreTheFewestThatGiveTheNumbersBack) {
  io::Decimals decimals(Scalar::kFloat64);
  EXPECT_EQ(decimals.count(), 0);
  decimals.add(0.5);
  EXPECT_EQ(decimals.count(), 1);
  decimals.add(5000123.4567);
  EXPECT_EQ(decimals.count(), 4);
  decimals.add(M_PI);
  EXPECT_EQ(decimals.count(), 15);
  decimals.add(1e5 / 3);
  EXPECT_FALSE(decimals.count());
  io::Decimals floats(Scalar::kFloat32);
  floats.add(static_cast<double>(0.1F));
  EXPECT_EQ(floats.count(), 1);
}

}  // namespace
}  // namespace g3r
