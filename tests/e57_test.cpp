// E57: files written here by libE57Format.
#include <gtest/gtest.h>

#include <cmath>

#include "counting_allocator.h"
#include "e57_samples.h"
#include "io/table.h"
#include "merge_checks.h"
#include "sanitized.h"
#include "stream_checks.h"

// What libE57Format does not free: its packets where memory runs out.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer's name
extern "C" const char* __lsan_default_suppressions() { return "leak:e57::CompressedVectorReaderImpl::CompressedVectorReaderImpl\n"; }

namespace g3r {
namespace {

using samples::e57_file;
using samples::e57_scan;
using samples::E57Field;
using samples::E57Scan;
using samples::message_of;
using samples::value_of;

constexpr double kHalf = 0.70710678118654752440;  // sqrt(1/2)

TEST(E57, EveryKindOfNumberIsReadAsItWasWritten) {
  for (const auto kind : {E57Field::kDouble, E57Field::kFloat, E57Field::kScaled}) {
    const std::size_t count = 5000;  // more than a block, and more than a packet
    const E57Scan scan = e57_scan(count, kind);
    const Cloud cloud = samples::read(e57_file({scan}));
    EXPECT_EQ(cloud.format, "e57");
    EXPECT_EQ(cloud.scalar, Scalar::kFloat64);
    EXPECT_TRUE(cloud.warnings.empty());
    ASSERT_EQ(cloud.positions.size(), count);
    ASSERT_EQ(cloud.colors.size(), count);
    const double most = kind == E57Field::kScaled ? 0.51 * samples::kE57Scale : 0;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_LE(std::abs(cloud.positions[i][a] - scan.fields[a].values[i]), most);
        EXPECT_EQ(cloud.colors[i][a], scan.fields[3 + a].values[i]);
      }
      EXPECT_EQ(value_of(cloud, "intensity", i), scan.fields[6].values[i]);
      EXPECT_EQ(value_of(cloud, "rowIndex", i), 7);
    }
  }
}

TEST(E57, ScansAreMergedEachInItsPose) {
  E57Scan turned = e57_scan(300, E57Field::kDouble);
  turned.rotation = {kHalf, 0, 0, kHalf};  // by 90 degrees about z: x -> y, y -> -x
  turned.translation = {5e5, 5.4e6, 100};
  const E57Scan plain = e57_scan(200, E57Field::kFloat);
  turned.fields.pop_back();
  turned.fields.push_back({"nor:normalX", E57Field::kDouble, std::vector<double>(300, 1)});
  turned.fields.push_back({"nor:normalY", E57Field::kDouble, std::vector<double>(300, 0)});
  turned.fields.push_back({"nor:normalZ", E57Field::kDouble, std::vector<double>(300, 0)});
  const Cloud cloud = samples::read(e57_file({turned, plain}));
  ASSERT_EQ(cloud.positions.size(), 500);
  constexpr double kRounding = 2e-9;  // of coordinates of millions
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_NEAR(cloud.positions[i][0], 5e5 - turned.fields[1].values[i], kRounding);
    EXPECT_NEAR(cloud.positions[i][1], 5.4e6 + turned.fields[0].values[i], kRounding);
    EXPECT_NEAR(cloud.positions[i][2], 100 + turned.fields[2].values[i], kRounding);
    EXPECT_NEAR(cloud.normals[i][0], 0, 1e-15);
    EXPECT_NEAR(cloud.normals[i][1], 1, 1e-15);
  }
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(cloud.positions[300 + i][a], plain.fields[a].values[i]);
    EXPECT_EQ(cloud.normals[300 + i], (Vec3{0, 0, 0}));  // which that scan does not have
  }
}

TEST(E57, ScannersStandAtTheOriginsOfTheirScans) {
  E57Scan turned = e57_scan(3, E57Field::kDouble);
  turned.rotation = {kHalf, 0, 0, kHalf};
  turned.translation = {5e5, 5.4e6, 100};
  E57Scan plain = e57_scan(2, E57Field::kFloat);
  EXPECT_TRUE(samples::read(e57_file({plain})).sensor_positions.empty());  // no pose: nobody knows
  const Cloud one = samples::read(e57_file({turned}));
  EXPECT_EQ(one.sensor_positions, (std::vector<Vec3>{{5e5, 5.4e6, 100}}));
  EXPECT_TRUE(one.scan_of_point.empty());
  plain.fields.back().values[0] = 2;  // an invalid point
  const Cloud two = samples::read(e57_file({turned, e57_scan(0, E57Field::kFloat), plain}));
  EXPECT_EQ(two.sensor_positions, (std::vector<Vec3>{{5e5, 5.4e6, 100}, {0, 0, 0}}));
  EXPECT_EQ(two.scan_of_point, (std::vector<std::uint32_t>{0, 0, 0, 1}));
}

TEST(E57, EveryAllocationMayFail) {
  const std::string bytes = e57_file({e57_scan(40, E57Field::kScaled)});
  bool reached = true;
  for (long n = 0; reached; ++n) {
    allocator::until_failure = n;
    try {
      EXPECT_EQ(samples::read(bytes).positions.size(), 40) << n;
    } catch (const std::bad_alloc&) {
    }
    reached = allocator::until_failure.exchange(-1) < 0;
  }
}

TEST(E57, SphericalCoordinatesBecomeCartesian) {
  E57Scan scan;
  scan.fields = {{"sphericalRange", E57Field::kDouble, {2, 2, 4}},
                 {"sphericalAzimuth", E57Field::kDouble, {0, std::acos(0.0), 0.5}},
                 {"sphericalElevation", E57Field::kDouble, {0, 0, std::acos(0.0)}}};
  const Cloud cloud = samples::read(e57_file({scan}));
  const std::vector<Vec3> expected = {{2, 0, 0}, {0, 2, 0}, {0, 0, 4}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(cloud.positions[i][a], expected[i][a], 1e-15);
  }
}

TEST(E57, InvalidPointsAreLeftOutAndCounted) {
  E57Scan scan = e57_scan(100, E57Field::kDouble);
  for (const std::size_t i : {0U, 50U, 99U}) scan.fields.back().values[i] = i == 50 ? 1 : 2;
  const Cloud cloud = samples::read(e57_file({scan}));
  ASSERT_EQ(cloud.positions.size(), 97);
  EXPECT_EQ(cloud.positions[0][2], scan.fields[2].values[1]);
  ASSERT_EQ(cloud.warnings.size(), 1);
  EXPECT_NE(cloud.warnings[0].find("3 points"), std::string::npos);
}

TEST(E57, ColoursOf16BitsAreKept) {
  E57Scan scan = e57_scan(256, E57Field::kDouble);
  for (std::size_t c = 3; c < 6; ++c) {
    scan.fields[c].high = 65535;
    for (double& v : scan.fields[c].values) v = v * 257 - (v > 0 ? 1 : 0);
  }
  const Cloud cloud = samples::read(e57_file({scan, e57_scan(2, E57Field::kFloat)}));
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(value_of(cloud, "red", i), scan.fields[3].values[i]);
  EXPECT_EQ(value_of(cloud, "blue", 256), 65535);  // 255 of 255 in the other scan
}

TEST(E57, IsWrittenAsOtherFormats) {
  const Cloud cloud = samples::read(e57_file({e57_scan(50, E57Field::kDouble)}));
  for (const char* name : {"a.ply", "a.pcd", "a.las", "a.xyz"}) {
    const Cloud back = samples::read(samples::written(cloud, name));
    EXPECT_EQ(back.positions.size(), cloud.positions.size());
    EXPECT_EQ(back.colors, cloud.colors) << name;
  }
}

TEST(E57, EmptyScansAreSkipped) {
  const Cloud cloud = samples::read(e57_file({e57_scan(0, E57Field::kDouble), e57_scan(3, E57Field::kDouble)}));
  EXPECT_EQ(cloud.positions.size(), 3);
  EXPECT_NE(message_of(e57_file({e57_scan(0, E57Field::kDouble)})).find("no points"), std::string::npos);
}

TEST(E57, CutAnywhereIsAnError) {
  const std::string bytes = e57_file({e57_scan(60, E57Field::kScaled)});
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_THROW(samples::read(bytes.substr(0, size)), InvalidInput) << size;
}

TEST(E57, AnyBitChangedIsAnError) {
  const std::string bytes = e57_file({e57_scan(60, E57Field::kFloat)});
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    EXPECT_THROW(samples::read(damaged), InvalidInput) << bit;
  }
}

// Memory beside the points: libE57Format's packets of one scan.
constexpr std::size_t kLibraries = std::size_t{8} << 20;

TEST(E57, MemoryIsThatOfTheFile) {
  for (const auto kind : {E57Field::kDouble, E57Field::kFloat, E57Field::kScaled}) {
    const std::string bytes = e57_file({e57_scan(20000, kind), e57_scan(20000, kind)});
    allocator::reset_peak();
    const std::size_t before = allocator::live;
    samples::read(bytes);
    EXPECT_LE(allocator::peak - before, 15 * bytes.size() + kLibraries);
  }
}

// Files of every kind that the tests above read.
std::vector<std::string> variants(std::size_t count) {
  E57Scan turned = e57_scan(count, E57Field::kDouble);
  turned.rotation = {kHalf, 0, 0, kHalf};
  turned.translation = {5e5, 5.4e6, 100};
  for (std::size_t i = 0; i < count; i += 3) turned.fields.back().values[i] = 1;  // not valid
  E57Scan sphere;
  sphere.fields = {{"sphericalRange", E57Field::kDouble, {2, 2, 4}},
                   {"sphericalAzimuth", E57Field::kDouble, {0, 1, 0.5}},
                   {"sphericalElevation", E57Field::kDouble, {0, 0, 1}}};
  E57Scan wide = e57_scan(count, E57Field::kScaled);
  wide.fields[3].high = 65535;
  return {e57_file({turned, e57_scan(0, E57Field::kFloat), sphere}), e57_file({wide, turned}),
          e57_file({e57_scan(count, E57Field::kFloat)})};
}

TEST(E57, IsAStreamOfTheSamePoints) {
  const samples::Folder folder;
  for (const std::size_t count : {40U, 9000U}) {  // more than two blocks
    for (const std::string& bytes : variants(count)) {
      samples::spill(folder.path("a.e57"), bytes);
      stream_checks::expect_what_read_cloud_gives(folder.path("a.e57"));
    }
  }
}

TEST(E57, TilesWriteWhatWriteCloudWrites) {
  const samples::Folder folder;
  const std::string path = folder.path("a.e57");
  for (const std::string& bytes : variants(40)) {
    samples::spill(path, bytes);
    merge_checks::expect_what_write_cloud_writes(path, {path});
  }
}

TEST(E57, MemoryOfAStreamDoesNotDependOnTheSizeOfTheFile) {
  constexpr std::size_t kMany = 120'000;
  const samples::Folder folder;
  samples::spill(folder.path("a.e57"), e57_file({e57_scan(kMany, E57Field::kDouble), e57_scan(kMany, E57Field::kDouble)}));
  allocator::reset_peak();
  const std::size_t before = allocator::live;
  const auto stream = io::open_points(folder.path("a.e57"), true);
  std::vector<Vec3> points;
  std::string records;
  std::size_t count = 0;
  for (stream->next(5000, points, &records); !points.empty(); stream->next(5000, points, &records)) count += points.size();
  EXPECT_EQ(count, 2 * kMany);
  EXPECT_LE(allocator::peak - before, kLibraries / 2);  // of a file of 8 MiB
}

TEST(E57, DamageInAStreamIsWhatItIsInTheWholeFile) {
  const samples::Folder folder;
  const std::string path = folder.path("a.e57");
  const std::string good = e57_file({e57_scan(40, E57Field::kScaled), e57_scan(20, E57Field::kFloat)});
  int refused = 0;
  for (std::size_t i = 0; i < 120; ++i) {
    std::string bad = good;
    const std::size_t at = i * good.size() / 120 + i % 7;
    if (i % 4 == 0) {
      bad.resize(at);
    } else {
      bad[at % bad.size()] = static_cast<char>(~bad[at % bad.size()]);
      if (i % 4 > 1) bad = samples::with_checksums(samples::without_checksums(bad));
    }
    samples::spill(path, bad);
    const std::string message = stream_checks::refusal_of_read_cloud(path);
    try {
      (void)stream_checks::streamed(path);
      EXPECT_EQ(message, "") << i;
    } catch (const InvalidInput& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
      EXPECT_NE(message, "") << error.what();
    }
  }
  EXPECT_GT(refused, 60);
}

// With checksums as if it had been written so: an error, or a cloud that is no larger than the file allows.
void expect_harmless(std::string bytes, const std::string& what) {
  bytes = samples::with_checksums(samples::without_checksums(bytes));
  allocator::reset_peak();
  const std::size_t before = allocator::live;
  try {
    samples::read(bytes);
  } catch (const InvalidInput&) {
  }
  EXPECT_LE(allocator::peak - before, 64 * 4 * bytes.size() + kLibraries) << what;
  EXPECT_LE(allocator::live, before) << what;
}

TEST(E57, DamageUnderGoodChecksumsIsHarmless) {
  constexpr std::size_t kStep = kSanitized ? 31 : 3;
  const std::string bytes = e57_file({e57_scan(40, E57Field::kScaled), e57_scan(20, E57Field::kFloat)});
  for (std::size_t at = 0; at < bytes.size(); at += kStep) {
    for (const char byte : {'\0', '\xFF', '9', '<', static_cast<char>(bytes[at] ^ 1)}) {
      std::string damaged = bytes;
      damaged[at] = byte;
      expect_harmless(damaged, "byte " + std::to_string(at));
    }
  }
  for (std::size_t size = 0; size < bytes.size(); size += kStep) expect_harmless(bytes.substr(0, size), "size " + std::to_string(size));
}

std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  const std::size_t at = bytes.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  bytes.replace(at, from.size(), to);
  return samples::with_checksums(samples::without_checksums(bytes));
}

TEST(E57, WhatCannotBeReadIsSaid) {
  const std::string bytes = e57_file({e57_scan(60, E57Field::kDouble)});
  EXPECT_NE(message_of(bytes.substr(0, 1024)).find("truncated"), std::string::npos);
  std::string damaged = bytes;
  damaged[100] = static_cast<char>(~damaged[100]);
  EXPECT_NE(message_of(damaged).find("checksum"), std::string::npos);
  EXPECT_NE(message_of(replaced(bytes, "recordCount=\"60\"", "recordCount=\"61\"")).find("declared"), std::string::npos);
  EXPECT_NE(message_of(replaced(bytes, "recordCount=\"60\"", "recordCount=\"-1\"")).find("negative"), std::string::npos);
  EXPECT_NE(message_of(replaced(bytes, "cartesianX", "cartesianQ")).find("cartesianX"), std::string::npos);
}

// A file without points whose XML is this.
std::string xml_file(const std::string& inside, const std::string& declaration = R"(<?xml version="1.0" encoding="UTF-8"?>)") {
  const std::string xml =
      declaration + R"(<e57Root type="Structure" xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0">)" + inside + "</e57Root>";
  constexpr std::uint64_t kHeader = 48;
  std::string logical = "ASTM-E57" + samples::raw(std::uint32_t{1}) + samples::raw(std::uint32_t{0}) + samples::raw(std::uint64_t{0});
  logical += samples::raw(kHeader) + samples::raw(std::uint64_t{xml.size()}) + samples::raw(std::uint64_t{samples::kE57Page});
  return samples::with_checksums(logical + xml);
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

TEST(E57, XmlThatWouldFetchOrTakeLongIsRefused) {
  EXPECT_NE(message_of(xml_file("")).find("no scans"), std::string::npos);
  const auto refused = [](const std::string& bytes, const std::string& why) {
    const std::string message = message_of(bytes);
    EXPECT_NE(message.find(why), std::string::npos) << message;
  };
  refused(xml_file("", R"(<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b SYSTEM "/etc/passwd">]>)"), "document type");
  refused(xml_file(R"(<a type="Float" xmlns:x="http://www.w3.org/2001/XMLSchema-instance" x:schemaLocation="a file:///a"/>)"), "schema");
  refused(xml_file("", R"(<?xml version="1.0" encoding="UTF-16"?>)"), "encoding");
  refused(xml_file("", " "), "<?xml");
  refused(xml_file(std::string(1, '\0')), "zero byte");
  refused(xml_file(R"(<a type="Compressed&#86;ector" fileOffset="48" recordCount="1"/>)"), "entities");
  refused(xml_file(R"(<a type="CompressedVector" fileOffset="48" recordCount="1"/>)"), "prototype");
  refused(xml_file(R"(<a type="Vector">)" + repeated(R"(<s type="Structure"/>)", 2) + "</a>"), "one type");
  refused(xml_file(repeated(R"(<a type="Structure">)", 40) + repeated("</a>", 40)), "nested");
  refused(xml_file(R"(<a type="Structure">)" + repeated(R"(<b type="Float"/>)", 300) + "</a>"), "children");
  refused(xml_file(R"(<a type="Float" )" + repeated(R"(b="" )", 70) + "/>"), "attributes");
  refused(xml_file("</a></a>"), "end tag");
  refused(xml_file("<!-- "), "truncated");
  refused(xml_file("<a"), "damaged");
  refused(xml_file(R"(<a type="Float)"), "truncated");
  refused(xml_file("<a/>"), "damaged");
}

// Fields whose values are all equal take no bytes: here eight points take one byte, and three doubles each in memory.
TEST(E57, PointsWithoutBytesBehindThemAreRefused) {
  const auto line = [](std::size_t count) {
    E57Scan scan;
    scan.fields.push_back({"cartesianX", E57Field::kInteger, std::vector<double>(count, 1), 0, 1});
    scan.fields.push_back({"cartesianY", E57Field::kInteger, std::vector<double>(count, 5), 5, 5});
    scan.fields.push_back({"cartesianZ", E57Field::kInteger, std::vector<double>(count, 6), 6, 6});
    return e57_file({scan});
  };
  EXPECT_EQ(samples::read(line(2000)).positions.back(), (Vec3{1, 5, 6}));
  EXPECT_NE(message_of(line(100000)).find("times its size"), std::string::npos);
}

}  // namespace
}  // namespace g3r
