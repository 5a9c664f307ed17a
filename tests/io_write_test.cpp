#include <g3r/io.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <filesystem>
#include <limits>

#include <sys/stat.h>

#include "german_locale.h"
#include "io/las.h"
#include "io/las_extra_bytes.h"
#include "io_samples.h"

namespace g3r {
namespace {

using namespace std::string_literals;

using samples::Folder;
using samples::read;
using samples::slurp;
using samples::spill;
using samples::value_of;
using Strings = std::vector<std::string>;

template <class Call>
void expect_io_error(IoError::Kind kind, const Call& call) {
  try {
    call();
    FAIL() << "no error";
  } catch (const IoError& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
  }
}

TEST(Orient, PlyKeepsEveryElementPropertyListAndComment) {
  const Cloud cloud = read(samples::big_endian_ply(7));
  const std::vector<Vec3> normals(7, Vec3{0, 0, 1});
  const std::vector<float> confidence(7, 0.25F);
  for (const bool ascii : {false, true}) {
    const Folder folder;
    write_cloud(folder.path("a.ply"), cloud, &normals, &confidence, {.ascii = ascii});
    const std::string bytes = slurp(folder.path("a.ply"));
    const std::string header = bytes.substr(0, bytes.find("end_header"));
    EXPECT_EQ(
        header.substr(header.find("1.0\n") + 4),
        "comment by hand\nobj_info kept too\nelement camera 1\nproperty uchar id\nelement vertex 7\nproperty float x\n"
        "property list uchar short seen\nproperty float y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\n"
        "property float confidence\n");
    const Cloud again = read(bytes);
    EXPECT_EQ(again.positions, cloud.positions);
    EXPECT_EQ(again.normals, normals);
    EXPECT_EQ(again.confidence, confidence);
    if (ascii) {
      EXPECT_NE(bytes.find("\n2 2 258 259 4 0.2 0 0 1 0.25\n"), std::string::npos) << bytes;
    }
  }
}

TEST(Orient, NormalsInTheFileAreReplacedInTheirPlace) {
  Cloud cloud = read(samples::written(samples::helix(6), "a.ply"));
  const std::vector<std::string> names = cloud.property_names;
  const std::vector<Vec3> normals(6, Vec3{0, 1, 0});
  const Folder folder;
  write_cloud(folder.path("a.ply"), cloud, &normals, nullptr);
  const Cloud again = read_cloud(folder.path("a.ply"));
  EXPECT_EQ(again.property_names, names);
  EXPECT_EQ(again.normals, normals);
}

TEST(Orient, WritingWhatWasReadGivesTheSameBytes) {
  for (const char* name : {"a.ply", "a.pcd", "a.las", "a.npy", "a.xyz", "a.csv"}) {
    const std::string bytes = samples::written(samples::helix(30), name);
    EXPECT_EQ(samples::written(read(bytes), name), bytes) << name;
  }
}

TEST(Orient, PcdAndLasKeepTheirFieldsAndTakeNormals) {
  for (const char* name : {"a.pcd", "a.las"}) {
    Cloud plain = samples::helix(9);
    plain.normals.clear();
    const Cloud cloud = read(samples::written(plain, name));
    const std::vector<Vec3> normals(9, Vec3{1, 0, 0});
    const std::vector<float> confidence(9, 0.5F);
    const Folder folder;
    write_cloud(folder.path(name), cloud, &normals, &confidence);
    const Cloud once = read_cloud(folder.path(name));
    EXPECT_TRUE(once.warnings.empty()) << name;
    EXPECT_EQ(once.positions, cloud.positions) << name;
    EXPECT_EQ(once.colors, plain.colors) << name;
    EXPECT_EQ(once.normals, normals) << name;
    EXPECT_EQ(once.confidence, confidence) << name;
    // A second time they are replaced, not added again.
    const std::vector<Vec3> others(9, Vec3{0, 0, -1});
    write_cloud(folder.path(name), once, &others, &confidence);
    const Cloud twice = read_cloud(folder.path(name));
    EXPECT_EQ(twice.normals, others) << name;
    EXPECT_EQ(twice.property_names, once.property_names) << name;
  }
}

TEST(Orient, WhatFollowsThePointsOfALasFileIsKeptAndFound) {
  // Two bytes without a description in every record, and an extended record after the points.
  const Cloud plain = [] {
    Cloud cloud;
    cloud.positions = samples::helix(3).positions;
    return cloud;
  }();
  std::string las = samples::written(plain, "a.las");
  constexpr std::size_t kHeader = 375;
  constexpr std::size_t kRecord = 20;
  ASSERT_EQ(las.size(), kHeader + 3 * kRecord);
  for (std::size_t i = 3; i > 0; --i) las.insert(kHeader + i * kRecord, "ab");
  las.replace(105, 2, samples::raw(static_cast<std::uint16_t>(kRecord + 2)));
  las.replace(235, 8, samples::raw(std::uint64_t{las.size()}));
  las.replace(243, 4, samples::raw(std::uint32_t{1}));
  las += "extended";
  const Cloud cloud = read(las);
  EXPECT_TRUE(cloud.warnings.empty());
  const std::vector<Vec3> normals(3, Vec3{0, 0, 1});
  const Folder folder;
  write_cloud(folder.path("a.las"), cloud, &normals, nullptr);
  const std::string bytes = slurp(folder.path("a.las"));
  const Cloud again = read(bytes);
  EXPECT_TRUE(again.warnings.empty());
  EXPECT_EQ(again.positions, cloud.positions);
  EXPECT_EQ(again.normals, normals);
  std::uint64_t extended = 0;
  std::memcpy(&extended, bytes.data() + 235, sizeof extended);
  EXPECT_EQ(bytes.substr(extended), "extended");
  EXPECT_EQ(bytes.substr(extended - 14, 2), "ab");  // before three floats
}

// A LAS file with these extra bytes in every record.
std::string las_with(const std::string& descriptors, const std::string& extra, std::size_t count) {
  Cloud plain;
  plain.positions = samples::helix(count).positions;
  const std::string las = samples::written(plain, "a.las");
  constexpr std::size_t kHeader = 375;
  constexpr std::size_t kRecord = 20;
  std::string bytes = las.substr(0, kHeader) + io::las_extra_vlr(descriptors.size()) + descriptors;
  io::las::put(bytes, io::las::kVlrCount, std::uint32_t{1});
  io::las::put(bytes, io::las::kPointsAt, static_cast<std::uint32_t>(bytes.size()));
  io::las::put(bytes, io::las::kRecordBytes, static_cast<std::uint16_t>(kRecord + extra.size()));
  for (std::size_t i = 0; i < count; ++i) bytes += las.substr(kHeader + i * kRecord, kRecord) + extra;
  return bytes;
}

// A descriptor with a scale and an offset.
std::string scaled_descriptor(const std::string& name, unsigned type, double scale, double offset) {
  std::string bytes = io::las_descriptor(name, type, 8 + 16);
  io::las::put(bytes, 112, scale);
  io::las::put(bytes, 136, offset);
  return bytes;
}

// The cloud with normals and confidence in a LAS file, as it is read.
Cloud oriented_las(const Cloud& cloud) {
  const std::vector<Vec3> normals(cloud.positions.size(), Vec3{0, 0, 1});
  const std::vector<float> confidence(cloud.positions.size(), 0.5F);
  const Folder folder;
  write_cloud(folder.path("a.las"), cloud, &normals, &confidence);
  Cloud again = read_cloud(folder.path("a.las"));
  EXPECT_EQ(again.normals, normals);
  EXPECT_EQ(again.confidence, confidence);
  EXPECT_TRUE(again.warnings.empty());
  return again;
}

TEST(LasExtraBytes, ThatAreNoFloatsMakeRoomForOursUnderAnotherName) {
  constexpr unsigned kUint8 = 1;
  constexpr unsigned kInt16 = 4;
  std::string descriptors = io::las_descriptor("confidence", kUint8, 0) + io::las_descriptor("confidence_2", kUint8, 0);
  for (const char* name : {"NormalX", "NormalY", "NormalZ"}) descriptors += scaled_descriptor(name, kInt16, 0.5, 0);
  const std::string extra = "\7\x8" + samples::raw(std::int16_t{1}) + samples::raw(std::int16_t{-2}) + samples::raw(std::int16_t{3});
  const Cloud cloud = read(las_with(descriptors, extra, 5));
  EXPECT_EQ(cloud.normals[4], (Vec3{0.5, -1, 1.5}));
  const Cloud once = oriented_las(cloud);
  const Strings added(once.property_names.end() - 9, once.property_names.end());
  EXPECT_EQ(added, (Strings{"confidence_3", "confidence_2", "NormalX_2", "NormalY_2", "NormalZ_2", "NormalX", "NormalY", "NormalZ",
                            "confidence"}));
  EXPECT_EQ(value_of(once, "confidence_3", 4), 7);
  EXPECT_EQ(value_of(once, "confidence_2", 4), 8);
  EXPECT_EQ(value_of(once, "NormalY_2", 4), -1);
  EXPECT_EQ(oriented_las(once).property_names, once.property_names);
}

TEST(LasExtraBytes, OfArraysAreSeveralNumbers) {
  constexpr unsigned kTwoUint16 = 13;
  constexpr unsigned kThreeFloats = 29;
  const std::string descriptors = io::las_descriptor("confidence", kTwoUint16, 0) + io::las_descriptor("vector", kThreeFloats, 0);
  const std::string extra =
      samples::raw(std::uint16_t{7}) + samples::raw(std::uint16_t{8}) + samples::raw(1.5F) + samples::raw(2.5F) + samples::raw(3.5F);
  const Cloud cloud = read(las_with(descriptors, extra, 5));
  EXPECT_EQ(value_of(cloud, "confidence_1", 4), 8);
  EXPECT_EQ(value_of(cloud, "vector_2", 4), 3.5);
  const Cloud once = oriented_las(cloud);
  EXPECT_EQ(value_of(once, "confidence_2_1", 4), 8);
  EXPECT_EQ(value_of(once, "vector_0", 4), 1.5);
}

TEST(LasExtraBytes, AreReadWithScaleAndOffsetAndKeptAsTheyAre) {
  constexpr unsigned kInt16 = 4;
  const std::string bytes =
      las_with(scaled_descriptor("amplitude", kInt16, 0.01, 100) + io::las_descriptor("width", kInt16, 0), "\x39\x30\5\0"s, 5);
  const Cloud cloud = read(bytes);
  EXPECT_EQ(value_of(cloud, "amplitude", 4), 223.45);
  EXPECT_EQ(value_of(cloud, "width", 4), 5);
  EXPECT_EQ(samples::written(cloud, "a.las"), bytes);
  EXPECT_EQ(value_of(read(samples::written(cloud, "a.ply")), "amplitude", 4), 223.45);
}

TEST(Write, ALocaleWithDecimalCommasChangesNothing) {
  const auto texts = [] {
    std::vector<std::string> all;
    for (const char* name : {"a.xyz", "a.csv", "a.pts", "a.ply", "a.pcd", "a.obj"})
      all.push_back(samples::written(samples::helix(5), name, {.ascii = true}));
    return all;
  };
  const std::vector<std::string> usual = texts();
  const GermanLocale german;
  if (!german.is_there()) GTEST_SKIP() << kNoGermanLocale;
  ASSERT_STREQ(std::localeconv()->decimal_point, ",");
  EXPECT_EQ(texts(), usual);
  for (const std::string& text : usual) EXPECT_EQ(read(text).positions, samples::helix(5).positions) << text;
}

TEST(Write, CoordinatesOfAllFormatsSurvive) {
  Cloud cloud;
  for (const Vec3& p : samples::helix(40).positions) cloud.positions.push_back({p[0] + 497233.125, p[1] + 5412345.5, p[2] + 311});
  for (const char* name : {"a.ply", "a.xyz", "a.txt", "a.csv", "a.pts", "a.pcd", "a.npy", "a.obj", "a.las"}) {
    const Cloud again = read(samples::written(cloud, name));
    ASSERT_EQ(again.positions.size(), 40U) << name;
    EXPECT_EQ(again.scalar, Scalar::kFloat64) << name;
    for (std::size_t i = 0; i < 40; ++i) {
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(again.positions[i][a], cloud.positions[i][a], std::string(name) == "a.las" ? 1e-6 : 0) << name;
    }
  }
}

TEST(Write, NormalsAndColoursOfAllFormatsSurvive) {
  const Cloud cloud = samples::helix(20);
  for (const char* name : {"a.ply", "a.xyz", "a.csv", "a.pcd", "a.npy", "a.obj", "a.las"}) {
    const Cloud again = read(samples::written(cloud, name));
    ASSERT_EQ(again.normals.size(), 20U) << name;
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(again.normals[7][a], cloud.normals[7][a], 1e-6) << name;
    if (std::string(name) != "a.npy") {
      EXPECT_EQ(again.colors, cloud.colors) << name;
    }
  }
}

TEST(Write, EveryPointFormatTakesEveryOther) {
  for (const samples::Sample& sample : samples::all()) {
    const Cloud cloud = read(sample.bytes, sample.name);
    EXPECT_TRUE(cloud.warnings.empty()) << sample.name << ": " << cloud.warnings[0];
    for (const char* name : {"a.ply", "a.xyz", "a.csv", "a.pts", "a.pcd", "a.npy", "a.obj", "a.las"}) {
      const Cloud again = read(samples::written(cloud, name));
      ASSERT_EQ(again.positions.size(), cloud.positions.size()) << sample.name << " to " << name;
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(again.positions.back()[a], cloud.positions.back()[a], 1e-8) << sample.name << " to " << name;
      EXPECT_EQ(again.normals.size(), std::string(name) == "a.pts" || cloud.normals.empty() ? again.normals.size() : cloud.normals.size());
    }
  }
}

TEST(Write, ExtraBytesOfLasHaveNamesOfTheirOwn) {
  const std::string long_name(40, 'n');
  const Cloud cloud =
      read("x y z intensity " + long_name + "1 " + long_name + "2 GPS_time\n0 0 0 5.5 6 7 inf\n1 0 0 9 10 11 12\n", "a.txt");
  const std::string bytes = samples::written(cloud, "a.las");
  for (const std::string& name :
       {std::string("intensity_2"), long_name.substr(0, 32), long_name.substr(0, 30) + "_2", std::string("GPS_time_2")}) {
    const std::size_t at = bytes.find(name);
    ASSERT_NE(at, std::string::npos) << name;
    EXPECT_EQ(bytes.find(name, at + 1), std::string::npos) << name;
    EXPECT_EQ(bytes[at - 2], 10) << "not an extra-bytes descriptor of type double: " << name;
  }
}

// A float under the name is taken for that of an earlier run; what else has it is somebody's.
TEST(Write, ConfidenceOfOthersIsKept) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const Cloud cloud = read(head + "property uchar confidence\nproperty float quality\nend_header\n1 2 3 40 0.5\n");
  EXPECT_EQ(cloud.confidence, std::vector<float>{40});
  const std::vector<float> confidence(1, 0.25F);
  for (const bool cloud_compare_names : {false, true}) {
    const std::string kept = cloud_compare_names ? "confidence" : "confidence_2";
    const std::string ours = cloud_compare_names ? "scalar_confidence" : "confidence";
    const Folder folder;
    const std::string path = folder.path("a.ply");
    write_cloud(path, cloud, nullptr, &confidence, {.cloud_compare_names = cloud_compare_names});
    for (int run = 0; run < 2; ++run) {
      const Cloud again = read_cloud(path);
      EXPECT_EQ(again.property_names, (Strings{"x", "y", "z", kept, "quality", ours}));
      EXPECT_EQ(value_of(again, kept, 0), 40);
      EXPECT_EQ(value_of(again, "quality", 0), 0.5);
      EXPECT_EQ(value_of(again, ours, 0), 0.25);
      write_cloud(path, again, nullptr, &confidence, {.cloud_compare_names = cloud_compare_names});
    }
  }
}

// With alpha 255 the bits of a packed colour are those of no number.
TEST(Write, PackedColoursSurviveAsText) {
  const std::uint32_t opaque = 0xFFC86432;
  const std::string bytes =
      "VERSION .7\nFIELDS x y z rgb _id _ _\nSIZE 4 4 4 4 4 1 4\nTYPE F F F F U U U\nCOUNT 1 1 1 1 1 4 1\nWIDTH 1\nHEIGHT 1\nPOINTS "
      "1\nDATA "
      "binary\n" +
      samples::raw(1.0F) + samples::raw(2.0F) + samples::raw(3.0F) + samples::raw(opaque) + samples::raw(7U) + samples::raw(0U) +
      samples::raw(0U);
  const Cloud cloud = read(bytes);
  for (const bool ascii : {false, true}) {
    const Cloud again = read(samples::written(cloud, "a.pcd", {.ascii = ascii}));
    EXPECT_EQ(again.colors, (std::vector<std::array<std::uint8_t, 3>>{{200, 100, 50}})) << ascii;
    EXPECT_EQ(again.property_names, (Strings{"x", "y", "z", "rgb", "_id"})) << "without padding";
    EXPECT_EQ(value_of(again, "_id", 0), 7);
  }
  EXPECT_NE(samples::written(cloud, "a.pcd", {.ascii = true}).find("1 2 3 " + std::to_string(opaque)), std::string::npos);
  const Cloud helix = samples::helix(9);
  EXPECT_EQ(read(samples::written(helix, "a.pcd", {.ascii = true})).colors, helix.colors);
}

// PLY has no integers of 64 bits.
TEST(Write, IntegersOf64BitsBecomeDoublesOfPly) {
  const std::string head = samples::npy_header("[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('id', '<i8')]", 1, "");
  const std::string npy =
      head + samples::raw(1.0F) + samples::raw(2.0F) + samples::raw(3.0F) + samples::raw(std::int64_t{-9007199254740992});
  const std::string pcd =
      "VERSION .7\nFIELDS x y z id\nSIZE 4 4 4 8\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n"
      "1 2 3 9007199254740992\n";
  for (const auto& [bytes, id] : {std::pair{npy, -9007199254740992.0}, {pcd, 9007199254740992.0}}) {
    const std::string ply = samples::written(read(bytes), "a.ply");
    EXPECT_NE(ply.find("property double id\n"), std::string::npos) << ply.substr(0, 200);
    EXPECT_EQ(samples::value_of(read(ply), "id", 0), id);
  }
}

TEST(Write, ConfidenceIsNamedForCloudCompareOnRequest) {
  const Cloud cloud = read(samples::written(samples::helix(4), "a.ply"));
  const std::vector<float> confidence(4, 1);
  const Folder folder;
  write_cloud(folder.path("a.ply"), cloud, nullptr, &confidence, {.cloud_compare_names = true});
  EXPECT_EQ(read_cloud(folder.path("a.ply")).property_names.back(), "scalar_confidence");
}

TEST(WriteMesh, EveryFormatGivesTheMeshBack) {
  Mesh mesh = samples::tetrahedron();
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.glb"}) {
    for (const bool ascii : {false, true}) {
      const std::string bytes = samples::written(mesh, name, {.ascii = ascii});
      const Mesh again = read_mesh_bytes(bytes.data(), bytes.size(), name);
      ASSERT_EQ(again.triangles.size(), 4U) << name;
      EXPECT_EQ(again.vertices.size(), 4U) << name;
      if (std::string(name) != "a.stl") {
        EXPECT_EQ(again.triangles, mesh.triangles) << name;
        EXPECT_EQ(again.vertices, mesh.vertices) << name;
      }
    }
  }
  mesh.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {250, 251, 252}};
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    const std::string bytes = samples::written(mesh, name);
    EXPECT_EQ(read_mesh_bytes(bytes.data(), bytes.size(), name).colors, mesh.colors) << name;
  }
}

TEST(WriteMesh, StlIsTextWhereFloatsWouldCollapseTriangles) {
  Mesh mesh = samples::tetrahedron();
  EXPECT_EQ(samples::written(mesh, "a.stl").size(), 84U + 4 * 50);
  for (Vec3& v : mesh.vertices) v = {v[0] + 497233.125, v[1] + 5412345.5, v[2] + 311};
  const std::string bytes = samples::written(mesh, "a.stl");
  EXPECT_EQ(bytes.substr(0, 6), "solid ");
  const Mesh again = read_mesh_bytes(bytes.data(), bytes.size(), "a.stl");
  ASSERT_EQ(again.vertices.size(), 4U);
  for (const Vec3& v : mesh.vertices) EXPECT_EQ(std::count(again.vertices.begin(), again.vertices.end(), v), 1);
}

TEST(WriteMesh, GlbKeepsGeoreferencedPositions) {
  Mesh mesh = samples::tetrahedron();
  for (Vec3& v : mesh.vertices) v = {v[0] + 497233.125, v[1] + 5412345.5, v[2] + 311};
  mesh.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {250, 251, 252}};
  const std::string bytes = samples::written(mesh, "a.glb");
  EXPECT_EQ(read_mesh_bytes(bytes.data(), bytes.size(), "a.glb").triangles, mesh.triangles);
  const Cloud cloud = read(bytes);
  EXPECT_TRUE(cloud.warnings.empty());
  ASSERT_EQ(cloud.positions.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(cloud.positions[i][a], mesh.vertices[i][a], 1e-6);
  }
}

TEST(WriteMesh, EmptyAndDamagedMeshesAreRefused) {
  const Folder folder;
  EXPECT_THROW(write_mesh(folder.path("a.ply"), Mesh{}), InvalidInput);
  Mesh mesh = samples::tetrahedron();
  mesh.vertices[0][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_mesh(folder.path("a.ply"), mesh), InvalidInput);
  EXPECT_EQ(folder.files(), 0U);
}

TEST(Write, WrongSizesAndNormalsThatAreNotFiniteAreRefused) {
  const Folder folder;
  const Cloud cloud = samples::helix(4);
  const std::vector<Vec3> few(3);
  EXPECT_THROW(write_cloud(folder.path("a.ply"), cloud, &few, nullptr), InvalidInput);
  const std::vector<Vec3> odd(4, Vec3{0, 0, std::numeric_limits<double>::infinity()});
  EXPECT_THROW(write_cloud(folder.path("a.ply"), cloud, &odd, nullptr), InvalidInput);
  EXPECT_THROW(write_cloud(folder.path("a.what"), cloud, nullptr, nullptr), InvalidInput);
  EXPECT_EQ(folder.files(), 0U);
}

TEST(Write, ModeAndLinksOfAnExistingFileAreKept) {
  const Folder folder;
  spill(folder.path("real.ply"), "old");
  ::chmod(folder.path("real.ply").c_str(), 0640);
  std::filesystem::create_symlink("real.ply", folder.path("link.ply"));
  write_cloud(folder.path("link.ply"), samples::helix(4), nullptr, nullptr);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("link.ply")));
  struct stat status {};
  ::stat(folder.path("real.ply").c_str(), &status);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
  EXPECT_EQ(read_cloud(folder.path("real.ply")).positions.size(), 4U);
  EXPECT_EQ(folder.files(), 2U);
}

TEST(Write, ATemporaryFileLeftBehindIsRemovedByTheNextWrite) {
  const Folder folder;
  spill(folder.path(".a.ply.g3r.tmp"), "left by a killed process");
  write_cloud(folder.path("a.ply"), samples::helix(4), nullptr, nullptr);
  EXPECT_EQ(folder.files(), 1U);
}

TEST(Write, NamesOf255BytesWork) {
  const Folder folder;
  const std::string name = std::string(251, 'n') + ".ply";
  write_cloud(folder.path(name), samples::helix(4), nullptr, nullptr);
  EXPECT_EQ(read_cloud(folder.path(name)).positions.size(), 4U);
}

TEST(Write, AFullDeviceIsAnErrorAndStaysADevice) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  expect_io_error(IoError::Kind::kFailed, [] { write_file("/dev/full", std::string(100, 'x')); });
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(CheckOutput, RefusesBeforeAnyWork) {
  const Folder folder;
  spill(folder.path("in.ply"), "x");
  std::filesystem::create_hard_link(folder.path("in.ply"), folder.path("hard.ply"));
  std::filesystem::create_symlink("in.ply", folder.path("soft.ply"));
  for (const char* name : {"in.ply", "./in.ply", "hard.ply", "soft.ply"}) {
    expect_io_error(IoError::Kind::kCannotCreate, [&] { check_output(folder.path(name), {folder.path("in.ply")}, false); });
  }
  expect_io_error(IoError::Kind::kCannotCreate, [&] { check_output(folder.path("no/such/out.ply"), {}, false); });
  std::filesystem::create_directory(folder.path("dir.ply"));
  expect_io_error(IoError::Kind::kCannotCreate, [&] { check_output(folder.path("dir.ply"), {}, false); });
  EXPECT_THROW(check_output(folder.path("out.what"), {}, false), InvalidInput);
  EXPECT_THROW(check_output(folder.path("out"), {}, true), InvalidInput);
  EXPECT_THROW(check_output(folder.path("out.las"), {}, true), InvalidInput);
  check_output(folder.path("out.glb"), {folder.path("in.ply")}, true);
  check_output("-", {}, false);
  EXPECT_EQ(folder.files(), 4U);
  if (::geteuid() != 0) {
    ::chmod(folder.path("dir.ply").c_str(), 0555);
    expect_io_error(IoError::Kind::kCannotCreate, [&] { check_output(folder.path("dir.ply/out.ply"), {}, false); });
  }
}

}  // namespace
}  // namespace g3r
