// Folders and patterns as one cloud, and boxes of any file.
#include <g3r/io.h>
#include <g3r/tiles.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "counting_allocator.h"
#include "io/ept.h"
#include "io/file_lists.h"
#include "io/table.h"
#include "io_samples.h"
#include "stream_checks.h"
#include "tiles/fewest_tiles.h"

namespace g3r {
namespace {

using samples::Folder;
using samples::read;
using samples::spill;
using Names = std::vector<std::string>;

double value(const Cloud& cloud, const std::string& property, std::size_t point) {
  const io::Element& points = cloud.attributes->points();
  const io::RecordLayout layout(points);
  const std::size_t found = points.find(property);
  return io::load_as_double(points.properties[found].type, points.data.data() + point * points.stride() + layout.offset(found));
}

TEST(Tiles, AFolderIsOneCloudInTheOrderOfNames) {
  const Folder folder;
  spill(folder.path("b.csv"), "x,y,z,i\n4,5,6,9\n");
  spill(folder.path("a.xyz"), "1 2 3\n");
  write_cloud(folder.path("c.las"), samples::helix(3), nullptr, nullptr);
  spill(folder.path("readme.txt"), "this is no cloud\n");
  const Cloud cloud = read_cloud(folder.path(""));
  EXPECT_EQ(cloud.format, "3 files");
  ASSERT_EQ(cloud.positions.size(), 5U);
  EXPECT_EQ(cloud.positions[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(cloud.positions[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(cloud.colors[1], (std::array<std::uint8_t, 3>{0, 0, 0}));
  EXPECT_EQ(cloud.colors[3], samples::helix(3).colors[1]);
  EXPECT_NEAR(cloud.normals[3][0], samples::helix(3).normals[1][0], 1e-6);
  EXPECT_EQ(value(cloud, "i", 1), 9);
  EXPECT_EQ(value(cloud, "i", 4), 0);
  EXPECT_EQ(value(cloud, "return_flags", 4), 9);
  EXPECT_EQ(read(samples::written(cloud, "a.ply")).positions, cloud.positions);
}

// One file shows that levels are of 16 bits; the dark points of another are of the same kind.
TEST(Tiles, ColoursOfAllFilesHaveOneDepth) {
  using Color = std::array<std::uint8_t, 3>;
  const Folder folder;
  const auto las = [&](const std::string& name, const std::string& rows) {
    write_cloud(folder.path(name), read("x y z red green blue\n" + rows), nullptr, nullptr);
  };
  las("a.las", "1 2 3 40000 300 0\n4 5 7 65535 1 2\n");
  spill(folder.path("b.csv"), "x,y,z,red,green,blue\n1,2,3,1,0.5,0\n");
  Cloud bytes = samples::helix(1);
  bytes.colors[0] = {10, 128, 255};
  write_cloud(folder.path("c.ply"), bytes, nullptr, nullptr);
  const std::string dark = samples::written(read("x y z red green blue\n1 2 3 257 0 0\n"), "d.las");
  spill(folder.path("d.las"), dark.substr(0, dark.size() - 6) + samples::raw(std::uint16_t{200}) + std::string(4, '\0'));
  const Cloud cloud = read_cloud(folder.path(""));
  EXPECT_EQ(cloud.colors, (std::vector<Color>{{156, 1, 0}, {255, 0, 0}, {255, 128, 0}, {10, 128, 255}, {1, 0, 0}}));
  EXPECT_EQ(value(cloud, "green", 0), 300);
  EXPECT_EQ(value(cloud, "green", 2), 32768);
  EXPECT_EQ(value(cloud, "green", 3), 128 * 257);
  EXPECT_EQ(value(cloud, "red", 4), 200);
  const Cloud ply = read(samples::written(cloud, "a.ply"));
  EXPECT_EQ(ply.colors, cloud.colors);
  EXPECT_EQ(value(ply, "red", 0), 156) << "between formats colours become bytes";
  EXPECT_EQ(value(read(samples::written(cloud, "a.las")), "green", 0), 300);
  std::filesystem::remove(folder.path("a.las"));  // the only one with more than 8 bits
  EXPECT_EQ(read_cloud(folder.path("")).colors[2], (Color{200, 0, 0}));
}

TEST(Tiles, WhatOthersCallConfidenceOrQualityIsKept) {
  const Folder folder;
  spill(folder.path("a.csv"), "x,y,z,quality\n1,2,3,7\n");
  spill(folder.path("b.csv"), "x,y,z,confidence\n1,2,3,0.5\n");
  const Cloud cloud = read_cloud(folder.path(""));
  EXPECT_EQ(cloud.confidence, (std::vector<float>{0, 0.5F}));
  EXPECT_EQ(value(cloud, "quality", 0), 7);
}

TEST(Tiles, APatternNamesItsFiles) {
  const Folder folder;
  spill(folder.path("1.txt"), "1 2 3\n");
  spill(folder.path("2.txt"), "4 5 6\n");
  spill(folder.path("2.xyz"), "7 8 9\n");
  const Cloud cloud = read_cloud(folder.path("?.txt"));
  EXPECT_EQ(cloud.format, "2 files of xyz");
  EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(read_cloud(folder.path("*.xyz")).positions, (std::vector<Vec3>{{7, 8, 9}}));
  EXPECT_THROW((void)read_cloud(folder.path("*.las")), IoError);
  spill(folder.path("a*.txt"), "0 0 1\n");
  EXPECT_EQ(read_cloud(folder.path("a*.txt")).positions.size(), 1U);  // a file of that very name
}

TEST(Tiles, ScannersAndWarningsOfAllFilesAreKept) {
  const Folder folder;
  spill(folder.path("a.ptx"), samples::ptx(3));
  spill(folder.path("b.ptx"), samples::ptx(3));
  const Cloud cloud = read_cloud(folder.path(""));
  EXPECT_EQ(cloud.sensor_positions, (std::vector<Vec3>{{5, 6, 7}, {5, 6, 8}, {5, 6, 7}, {5, 6, 8}}));
  EXPECT_EQ(cloud.scan_of_point, (std::vector<std::uint32_t>{0, 0, 1, 1, 1, 2, 2, 3, 3, 3}));
  for (int i = 0; i < 12; ++i) spill(folder.path("open" + std::to_string(i) + ".xyz"), "1 2 3");
  const Cloud more = read_cloud(folder.path(""));
  EXPECT_TRUE(more.sensor_positions.empty());  // not known of all
  ASSERT_EQ(more.warnings.size(), 9U);
  EXPECT_NE(more.warnings[0].find("open0.xyz: the last line"), std::string::npos);
  EXPECT_EQ(more.warnings[8], "and 4 more warnings about these files");
}

TEST(Tiles, ListsAndVirtualPointCloudsNameTheirFiles) {
  const Folder folder;
  spill(folder.path("a.xyz"), "1 2 3\n");
  spill(folder.path("b.xyz"), "4 5 6\n");
  const std::vector<Vec3> both = {{4, 5, 6}, {1, 2, 3}};
  spill(folder.path("all.list"), "# of today\nb.xyz\n\n" + folder.path("a.xyz") + "\n");
  EXPECT_EQ(read_cloud(folder.path("all.list")).positions, both);
  const auto vpc = [](const std::string& first, const std::string& second) {
    return R"({"type": "FeatureCollection", "features": [{"type": "Feature", "assets": {"data": {"href": ")" + first +
           R"("}, "overview": {"href": "none.copc.laz"}}}, {"assets": {"data": {"href": ")" + second + R"("}}}]})";
  };
  spill(folder.path("all.vpc"), vpc("./b.xyz", ".\\/a.xyz"));
  EXPECT_EQ(read_cloud(folder.path("all.vpc")).positions, both);
  for (const char* list : {"all.list", "all.vpc"}) EXPECT_THROW((void)read_mesh(folder.path(list)), NoFaces) << list;
  EXPECT_THROW((void)read_mesh(folder.path("none.list")), IoError);
  const auto complaint = [&](const std::string& name, const std::string& bytes) -> std::string {
    spill(folder.path(name), bytes);
    try {
      (void)read_cloud(folder.path(name));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(complaint("c.vpc", vpc("b.xyz", "https://x/a.laz")).find("not on this machine"), std::string::npos);
  EXPECT_NE(complaint("c.vpc", "{}").find("c.vpc: expected a FeatureCollection"), std::string::npos);
  EXPECT_NE(complaint("c.vpc", R"({"features": [{"assets": 3}]})").find("c.vpc: feature 1: expected the path"), std::string::npos);
  EXPECT_NE(complaint("c.list", "# nothing\n").find("c.list: names no files"), std::string::npos);
  EXPECT_NE(complaint("c.vpc", R"({"features": [1]})").find("c.vpc: feature 1: expected the path"), std::string::npos);
  EXPECT_NE(complaint("c.vpc", vpc("b.xyz", "a.xyz") + "}").find("c.vpc: expected a FeatureCollection"), std::string::npos);
  EXPECT_NE(complaint("c.list", "none.xyz\n").find("none.xyz"), std::string::npos);
  EXPECT_NE(complaint("c.list", "/dev/zero\n").find("c.list: names \"/dev/zero\", which is no file"), std::string::npos);
  EXPECT_NE(complaint("c.list", ".\n").find("which is no file"), std::string::npos);
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(folder.path(""));
  spill("c.list", "-\n");
  EXPECT_EQ(io::files_of_list("c.list"), Names{"./-"});  // not standard input
  std::filesystem::current_path(here);
}

TEST(Tiles, MemoryOfListsKeepsTheLaw) {
  const Folder folder;
  std::string ones = "1";
  while (ones.size() < 1 << 20) ones += "," + ones;
  const auto expect_law = [&](const std::string& name, const std::string& bytes) {
    spill(folder.path(name), bytes);
    const std::size_t before = allocator::live;
    allocator::reset_peak();
    EXPECT_THROW((void)read_cloud(folder.path(name)), InvalidInput) << name;
    EXPECT_LT(allocator::peak - before, 16 * bytes.size() + (1 << 20)) << name;  // SECURITY.md
  };
  expect_law("values.vpc", R"({"features": [{"values": [)" + ones + "]}]}");
  expect_law("deep.vpc", R"({"features": [{"assets": )" + std::string(1 << 20, '['));
  expect_law("text.vpc", R"({"features": [{"assets": ")" + ones);
  expect_law("unnamed.list", std::string(1 << 20, '#'));
}

TEST(Tiles, DamageNamesTheFile) {
  const Folder folder;
  spill(folder.path("a.xyz"), "1 2 3\n");
  spill(folder.path("b.ply"), "ply\nnothing\n");
  try {
    (void)read_cloud(folder.path(""));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("b.ply"), std::string::npos);
  }
  const Folder empty;
  EXPECT_THROW((void)read_cloud(empty.path("")), IoError);
}

TEST(Box, LeavesOutWhatIsOutside) {
  ReadOptions options;
  options.box = Box{{0, -1, -1}, {1, 1, 0.35}};
  const Cloud helix = samples::helix(12);
  std::vector<Vec3> expected;
  for (const Vec3& p : helix.positions) {
    if (p[0] >= 0 && p[2] <= 0.35) expected.push_back(p);
  }
  for (const char* name : {"a.ply", "a.pcd", "a.las", "a.xyz", "a.obj", "a.npy"}) {
    const std::string bytes = samples::written(helix, name);
    const Cloud part = read_cloud_bytes(bytes.data(), bytes.size(), name, options);
    ASSERT_EQ(part.positions.size(), expected.size()) << name;
    EXPECT_TRUE(part.warnings.empty()) << name;
    EXPECT_TRUE(part.colors.empty() || part.colors.size() == expected.size()) << name;
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(part.positions[i][1], expected[i][1], 1e-8) << name;
    const Cloud again = read(samples::written(part, name));  // header and table fit what is left
    EXPECT_EQ(again.positions.size(), expected.size()) << name;
    EXPECT_TRUE(again.warnings.empty()) << name;
  }
}

TEST(Box, OfSeveralFilesOrWithoutPointsIsSaid) {
  const Folder folder;
  spill(folder.path("a.xyz"), "1 2 3\n");
  spill(folder.path("b.xyz"), "4 5 6\n");
  ReadOptions options;
  options.box = Box{{4, 5, 6}, {4, 5, 6}};  // the surface counts
  EXPECT_EQ(read_cloud(folder.path(""), options).positions, (std::vector<Vec3>{{4, 5, 6}}));
  options.box = Box{{7, 7, 7}, {8, 8, 8}};
  EXPECT_THROW((void)read_cloud(folder.path(""), options), InvalidInput);
  EXPECT_THROW((void)read_cloud(folder.path("a.xyz"), options), InvalidInput);
  options.box = Box{{1, 1, 1}, {0, 2, 2}};
  EXPECT_THROW((void)read_cloud(folder.path("a.xyz"), options), InvalidInput);
  options.box = {};
  options.levels = 3;
  EXPECT_EQ(read_cloud(folder.path("a.xyz"), options).warnings.size(), 1U);
}

// Records of X Y Z (steps of 0.5 from 10), Red (u16) and GpsTime in two cells, of which the second is in a page of its own.
void make_ept(const Folder& folder, const std::string& data_type = "binary") {
  std::filesystem::create_directories(folder.path("ept-hierarchy"));
  std::filesystem::create_directories(folder.path("ept-data"));
  std::string schema;
  for (const char* axis : {"X", "Y", "Z"})
    schema += std::string(R"({"name":")") + axis + R"(","type":"signed","size":4,"scale":0.5,"offset":10},)";
  spill(folder.path("ept.json"),
        R"({"bounds":[0,0,0,32,32,32],"dataType":")" + data_type + R"(","hierarchyType":"json","points":3,"schema":[)" + schema +
            R"({"name":"Intensity","type":"unsigned","size":2},{"name":"GpsTime","type":"float","size":8}],"version":"1.0.0"})");
  spill(folder.path("ept-hierarchy/0-0-0-0.json"), R"({"0-0-0-0": 2, "1-1-0-0": -1, "1-0-0-0": 0})");
  spill(folder.path("ept-hierarchy/1-1-0-0.json"), R"({"1-1-0-0": 1, "0-0-0-0": -1})");
  const auto record = [](std::int32_t x, std::uint16_t intensity) {
    return samples::raw(x) + samples::raw(std::int32_t{4}) + samples::raw(std::int32_t{6}) + samples::raw(intensity) +
           samples::raw(1e8 + x);
  };
  spill(folder.path("ept-data/0-0-0-0.bin"), record(0, 7) + record(2, 8));
  spill(folder.path("ept-data/1-1-0-0.bin"), record(20, 9));
}

TEST(Ept, CellsAreOneCloud) {
  const Folder folder;
  make_ept(folder);
  for (const char* name : {"", "ept.json"}) {
    const Cloud cloud = read_cloud(folder.path(name));
    EXPECT_EQ(cloud.format, "ept, 2 cells of records");
    EXPECT_EQ(cloud.positions, (std::vector<Vec3>{{10, 12, 13}, {11, 12, 13}, {20, 12, 13}}));
    EXPECT_EQ(value(cloud, "intensity", 2), 9);
    EXPECT_EQ(value(cloud, "gpstime", 2), 1e8 + 20);
  }
  stream_checks::expect_what_read_cloud_gives(folder.path("ept.json"));
  EXPECT_EQ(io::ept_files(folder.path("ept.json")), Names{folder.path("ept.json")});
  EXPECT_FALSE(needs_tiles({folder.path("")}, 1000));
  ReadOptions options;
  options.levels = 1;
  EXPECT_EQ(read_cloud(folder.path(""), options).positions.size(), 2U);
  options.levels = 0;
  options.box = Box{{15, 0, 0}, {30, 30, 30}};
  EXPECT_EQ(read_cloud(folder.path(""), options).positions, (std::vector<Vec3>{{20, 12, 13}}));
  options.box = Box{{0, 0, 20}, {30, 30, 30}};
  EXPECT_THROW((void)read_cloud(folder.path(""), options), InvalidInput);
}

TEST(Ept, IsNoMesh) {
  const Folder folder;
  make_ept(folder);
  EXPECT_THROW((void)read_mesh(folder.path("ept.json")), NoFaces);
}

TEST(Ept, DamageIsSaid) {
  const Folder folder;
  const auto message = [&] {
    try {
      (void)read_cloud(folder.path(""));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  make_ept(folder, "zstandard");
  EXPECT_NE(message().find("dataType"), std::string::npos) << message();
  make_ept(folder);
  spill(folder.path("ept-data/1-1-0-0.bin"), std::string(21, '\0'));
  EXPECT_NE(message().find("1-1-0-0.bin: truncated"), std::string::npos) << message();
  std::filesystem::remove(folder.path("ept-data/1-1-0-0.bin"));
  EXPECT_NE(message().find("No such file"), std::string::npos) << message();
  for (const char* page : {R"({"0-0-0-0": 2, "../etc": 5})", R"({"1-2-0-0": 5})", R"({"0-0-0-0": -2})", R"({"99-0-0-0": 1})", "[]", "{"}) {
    make_ept(folder);
    spill(folder.path("ept-hierarchy/0-0-0-0.json"), page);
    EXPECT_NE(message().find("ept-hierarchy/0-0-0-0.json: "), std::string::npos) << page << ": " << message();
  }
  make_ept(folder);
  const std::string description = samples::slurp(folder.path("ept.json"));
  for (std::size_t at = 0; at < description.size(); ++at) {
    for (const char byte : {'\0', '9', '"', ']', '-'}) {
      std::string damaged = description;
      damaged[at] = byte;
      spill(folder.path("ept.json"), damaged);
      (void)message();  // an error or a cloud
    }
  }
}

// Tiles of as many points each as there are: ten fit where a tenth does, and where surroundings are all no number does.
TEST(CutIntoFewest, StopsWhereTheLargestFitsOrNoneCan) {
  std::vector<std::size_t> tried;
  const auto even = [&](std::size_t count) {
    tried.push_back(count);
    return std::uint64_t{1000 / count};
  };
  EXPECT_TRUE(tiles::cut_into_fewest(1, 500, 100, even));
  EXPECT_EQ(tried, (std::vector<std::size_t>{1, 2, 3, 4, 6, 8, 11}));
  EXPECT_TRUE(tiles::cut_into_fewest(20, 500, 100, even));
  EXPECT_FALSE(tiles::cut_into_fewest(1, 5, 100, even));
  EXPECT_EQ(tried.back(), 5U);
  tried.clear();
  const auto surroundings = [&](std::size_t count) {
    tried.push_back(count);
    return std::uint64_t{500};
  };
  EXPECT_FALSE(tiles::cut_into_fewest(1, 100000, 100, surroundings));
  EXPECT_GT(tried.back(), 64U);
  EXPECT_LT(tried.back(), 100U);
}

}  // namespace
}  // namespace g3r
