// Files of scanners and of splats: PTX with its poses, SPZ, and what other programs do to PLY, PCD and LAS.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/table.h"
#include "io_samples.h"

namespace g3r {
namespace {

using samples::message_of;
using samples::read;
using samples::value_of;
using Names = std::vector<std::string>;

TEST(Ptx, ScansAreMergedEachInItsPose) {
  const Cloud cloud = read(samples::ptx(6));
  EXPECT_EQ(cloud.format, "ptx");
  EXPECT_TRUE(cloud.warnings.empty());
  ASSERT_EQ(cloud.positions.size(), 4U + 6U);  // two beams met nothing
  const Cloud helix = samples::helix(6);
  constexpr double kDigits = 1e-6;  // of the text
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3& p = helix.positions[i + i / 2];
    const Vec3 turned{5 - p[1], 6 + p[0], 7 + p[2]};
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(cloud.positions[i][a], turned[a], kDigits);
  }
  EXPECT_EQ(cloud.positions[6], (Vec3{5 - 2, 6 + 1, 8 + 2}));
  EXPECT_EQ(cloud.property_names, (Names{"x", "y", "z", "intensity", "red", "green", "blue"}));
  EXPECT_EQ(value_of(cloud, "intensity", 0), 0.25);
  EXPECT_EQ(value_of(cloud, "intensity", 9), 0.75);
  EXPECT_EQ(cloud.colors[0], (std::array<std::uint8_t, 3>{0, 0, 0}));  // that scan has none
  EXPECT_EQ(cloud.colors[4], (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_EQ(cloud.sensor_positions, (std::vector<Vec3>{{5, 6, 7}, {5, 6, 8}}));
  EXPECT_EQ(cloud.scan_of_point, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1, 1, 1, 1, 1}));
}

const std::string kPose = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST(Ptx, OneScanWithColoursAlone) {
  const Cloud cloud = read("1\n2\n" + kPose + "1 2 3 9 8 7\n4 5 6 1 2 3\n");
  EXPECT_EQ(cloud.positions[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(cloud.colors[0], (std::array<std::uint8_t, 3>{9, 8, 7}));
  EXPECT_EQ(cloud.sensor_positions.size(), 1U);
  EXPECT_TRUE(cloud.scan_of_point.empty());
  EXPECT_EQ(read("1\n1\n" + kPose + "1 2 3\n").positions[0], (Vec3{1, 2, 3}));
}

TEST(Ptx, WhatIsWrongIsSaid) {
  EXPECT_NE(message_of("2\n2\n" + kPose + "1 2 3 0.5\n").find("truncated"), std::string::npos);
  EXPECT_NE(message_of("4294967296\n4294967296\n" + kPose + "1 2 3 0.5\n").find("count too large"), std::string::npos);
  EXPECT_NE(message_of("1\n1\n" + kPose + "1 2 3 0.5\n4 5 6 0.5\n").find("line 12: expected the columns of the next scan"),
            std::string::npos);
  EXPECT_NE(message_of("1\n1\n" + kPose + "1 2 3 4 5\n").find("line 11: expected x y z, then"), std::string::npos);
  EXPECT_NE(message_of("1\n2\n" + kPose + "1 2 3 4\n1 2 3\n").find("line 12"), std::string::npos);
  std::string transposed = "1\n1\n" + kPose + "1 2 3\n";
  transposed.replace(transposed.find("1 0 0 0\n"), 8, "1 0 0 9\n");
  EXPECT_NE(message_of(transposed).find("last column is 0 0 0 1"), std::string::npos);
  EXPECT_NE(message_of("1\n1\n0 0 0\n").find("ten lines"), std::string::npos);
}

TEST(Spz, PositionsColoursAndOpacityAreUnpacked) {
  for (const std::uint32_t version : {2U, 3U}) {
    const std::string file = samples::gzip(samples::unpacked_spz(3, version, true));
    const Cloud cloud = read_cloud_bytes(file.data(), file.size(), "splats", {.all_splats = true});
    EXPECT_EQ(cloud.format, "spz version " + std::to_string(version) + ", Gaussian splats");
    EXPECT_TRUE(cloud.warnings.empty());
    EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{0, 0, 0}, {1, -1, 0.25}, {2, -2, 0.5}}));
    EXPECT_EQ(cloud.colors[0], (std::array<std::uint8_t, 3>{189, 128, 68}));  // 0.5 + Y_0 (c / 255 - 0.5) / 0.15
    EXPECT_NEAR(value_of(cloud, "opacity", 1), std::log(2.0 / 253), 1e-5);
    EXPECT_EQ(value_of(cloud, "scale_2", 0), -3);
    double length = 0;
    for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) length += std::pow(value_of(cloud, name, 2), 2);
    EXPECT_NEAR(length, 1, 2e-2);
    EXPECT_NEAR(value_of(cloud, "rot_1", 2), version == 2 ? 1 : std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(value_of(cloud, "rot_3", 2), version == 2 ? 0.5 / 127.5 : -std::sqrt(0.5) * 255 / 511, 1e-6);
    EXPECT_EQ(read(file).positions.size(), 2U);  // one is below the least opacity
  }
}

TEST(Spz, WhatIsWrongIsSaid) {
  const std::string good = samples::unpacked_spz(3, 3);
  EXPECT_NE(message_of("NGSP" + samples::raw(std::uint32_t{4}) + "more").find("version 4"), std::string::npos);
  EXPECT_NE(message_of(samples::gzip("NGSP" + samples::raw(std::uint32_t{1}) + good.substr(8))).find("found 1"), std::string::npos);
  EXPECT_NE(message_of(samples::gzip(good.substr(0, 60))).find("truncated"), std::string::npos);
  EXPECT_NE(message_of(samples::gzip("NGSP")).find("16 bytes"), std::string::npos);
  std::string many = good;
  many[10] = 1;
  EXPECT_NE(message_of(samples::gzip(many)).find("count is damaged"), std::string::npos);
  std::string damaged = samples::gzip(good);
  damaged[damaged.size() - 6] = static_cast<char>(damaged[damaged.size() - 6] ^ 1);
  EXPECT_NE(message_of(damaged).find("checksum"), std::string::npos);
  EXPECT_EQ(read(samples::gzip(good + "more")).warnings.size(), 1U);
  EXPECT_NE(message_of(samples::gzip("1 2 3\n")).find("gzip"), std::string::npos);
}

TEST(Capitals, AreAxesToo) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float X\nproperty float Y\nproperty float Z\nend_header\n1 2 3\n";
  const Cloud ply = read(head);
  EXPECT_EQ(ply.positions[0], (Vec3{1, 2, 3}));
  const Cloud written = read(samples::written(ply, "a.ply"));
  EXPECT_EQ(written.positions, ply.positions);
  EXPECT_EQ(written.property_names, (Names{"x", "y", "z"}));
  EXPECT_EQ(read(samples::written(ply, "a.las")).positions, ply.positions);
  EXPECT_EQ(read("FIELDS X Y Z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n1 2 3\n").positions[0], (Vec3{1, 2, 3}));
  std::string lists = head;
  lists.replace(lists.find("float Y"), 7, "list uchar float Y");
  lists.replace(lists.find("1 2 3"), 5, "1 1 2 3");
  EXPECT_NE(message_of(lists).find("list"), std::string::npos);
}

TEST(Pcd, TakesTheScannerOfOtherFormats) {
  const std::vector<Vec3> scanner = {{5, 6.5, -7}};
  Cloud cloud = samples::helix(3);
  cloud.sensor_positions = scanner;
  EXPECT_EQ(read(samples::written(cloud, "a.pcd")).sensor_positions, scanner);
}

TEST(Pcd, CommasBetweenNumbersAreTaken) {
  const std::string head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nDATA ascii\n";
  EXPECT_EQ(read(head + "1,2,3\n4, 5, 6\n").positions[1], (Vec3{4, 5, 6}));
  EXPECT_NE(message_of(head + "0,5 0,25 0,1\n1 2 3\n").find("decimal comma"), std::string::npos);
}

TEST(Pcd, ZerosAfterCompressedDataArePadding) {
  EXPECT_TRUE(read(samples::compressed_pcd(9) + std::string(512, '\0')).warnings.empty());
  EXPECT_EQ(read(samples::compressed_pcd(9) + std::string(512, '\0') + "x").warnings.size(), 1U);
}

TEST(Colours, ThatAreAllZeroAreNone) {
  Cloud black = samples::helix(4);
  for (auto& color : black.colors) color = {};
  for (const char* name : {"a.las", "a.ply", "a.pcd", "a.obj", "a.xyz"}) {
    const Cloud cloud = read(samples::written(black, name));
    EXPECT_TRUE(cloud.colors.empty()) << name;
    EXPECT_TRUE(cloud.warnings.empty()) << name;
  }
  const Cloud las = read(samples::written(black, "a.las"));
  const Cloud ply = read(samples::written(las, "a.ply"));
  EXPECT_EQ(std::count(ply.property_names.begin(), ply.property_names.end(), "red"), 0);  // nothing shows black
  EXPECT_EQ(read(samples::written(las, "a.las")).property_names, las.property_names);
}

}  // namespace
}  // namespace g3r
