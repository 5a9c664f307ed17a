// LAZ against LAS: files compressed here with LASzip's encoder.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "counting_allocator.h"
#include "io/ept.h"
#include "io/laz.h"
#include "io/table.h"
#include "laz_samples.h"
#include "merge_checks.h"
#include "sanitized.h"
#include "stream_checks.h"

// LASzip's encoder keeps its list of chunks of different sizes for ever.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer's name
extern "C" const char* __lsan_default_suppressions() { return "leak:LASwritePoint::add_chunk_to_table\n"; }

namespace g3r {
namespace {

using samples::compressed;
using samples::Folder;
using samples::kAnyChunks;
using samples::las_file;
using samples::load_points_at;
using samples::message_of;
using samples::put;

std::string unpacked(const std::string& laz) {
  const io::Source source{laz, "sample"};
  return io::unpack_laz(source, io::read_las_header(source));
}

TEST(Laz, EveryPointFormatUnpacksToTheBytesOfTheLasFile) {
  for (unsigned format = 0; format <= 10; ++format) {
    for (const bool extra : {false, true}) {
      const std::string las = las_file(format, 1000, extra);
      for (const std::uint32_t chunk : {50000U, 100U, 7U, kAnyChunks}) {
        if (kSanitized && chunk == 100U) continue;
        EXPECT_TRUE(unpacked(compressed(las, chunk)) == las) << "format " << format << ", extra " << extra << ", chunks of " << chunk;
      }
      for (const std::size_t count : {0U, 1U, 2U}) {
        const std::string small = las_file(format, count, extra);
        EXPECT_TRUE(unpacked(compressed(small)) == small) << "format " << format << ", " << count << " points";
      }
      if (format >= 4 && format < 6) continue;  // their waveforms have one version
      const unsigned other_version = format >= 6 ? 4 : 1;
      EXPECT_TRUE(unpacked(compressed(las, 100, other_version)) == las) << "format " << format << ", version " << other_version;
    }
  }
}

TEST(Laz, WhatFollowsThePointsFollowsThem) {
  for (const unsigned format : {3U, 6U}) {
    const std::string las = las_file(format, 300, false, std::string(60, '\0') + "after the points");
    EXPECT_TRUE(unpacked(compressed(las)) == las);
  }
}

TEST(Laz, ReadsAndIsWrittenLikeLas) {
  const std::string las = las_file(7, 2000, true);
  const Cloud expected = samples::read(las);
  const Cloud cloud = samples::read(compressed(las));
  EXPECT_EQ(cloud.format, "laz 1.4, point format 7");
  EXPECT_EQ(cloud.positions, expected.positions);
  EXPECT_EQ(cloud.colors, expected.colors);
  EXPECT_EQ(cloud.warnings, expected.warnings);
  const io::Element& points = cloud.attributes->points();
  const io::Element& wanted = expected.attributes->points();
  ASSERT_EQ(points.properties.size(), wanted.properties.size());
  for (std::size_t i = 0; i < points.properties.size(); ++i) EXPECT_EQ(points.properties[i].name, wanted.properties[i].name);
  EXPECT_TRUE(points.data == wanted.data);
  EXPECT_NE(points.find("range"), io::Element::npos);
  EXPECT_TRUE(samples::written(cloud, "a.las") == samples::written(expected, "a.las"));
}

TEST(Laz, IsWrittenSoThatItReadsAsTheLasFile) {
  for (unsigned format = 0; format <= 10; ++format) {
    for (const std::size_t count : {0U, 1U, 1000U}) {
      const std::string las = las_file(format, count, true, std::string(60, '\0') + "after the points");
      const std::string laz = samples::written(samples::read(las), "a.laz");
      EXPECT_TRUE(unpacked(laz) == samples::written(samples::read(las), "a.las")) << "format " << format << ", " << count << " points";
      if (count == 1000) {
        EXPECT_LT(laz.size(), las.size()) << format;
      }
    }
  }
}

TEST(Laz, ManyChunksAreWritten) {
  const std::string las = las_file(6, 120000, false);
  const Cloud cloud = samples::read(las);
  const std::string laz = samples::written(cloud, "a.laz");
  EXPECT_TRUE(unpacked(laz) == las);
  const Folder folder;
  const std::vector<Vec3> normals(cloud.positions.size(), Vec3{0, 0, 1});
  write_cloud(folder.path("a.laz"), cloud, &normals, nullptr);
  const Cloud oriented = read_cloud(folder.path("a.laz"));
  EXPECT_EQ(oriented.positions, cloud.positions);
  EXPECT_EQ(oriented.normals[119999], (Vec3{0, 0, 1}));
}

TEST(Laz, OtherFormatsBecomeLazToo) {
  const Cloud cloud = samples::helix(200);
  const Cloud back = samples::read(samples::written(cloud, "a.laz"));
  EXPECT_EQ(back.format, "laz 1.4, point format 2");
  EXPECT_EQ(back.colors, cloud.colors);
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(back.positions[i][a], cloud.positions[i][a], 5.1e-9 * 8);
    EXPECT_NEAR(back.normals[i][0], cloud.normals[i][0], 1e-6);
  }
}

Cloud read_part(const std::string& bytes, const ReadOptions& options) {
  return read_cloud_bytes(bytes.data(), bytes.size(), "part", options);
}

TEST(Copc, IsReadWholeByLevelsAndByBox) {
  const std::string file = samples::copc_file();
  const Cloud whole = samples::read(file);
  EXPECT_EQ(whole.format, "laz 1.4, point format 6, COPC");
  ASSERT_EQ(whole.positions.size(), 18U);
  EXPECT_EQ(whole.positions[12], (Vec3{2, 12, -3}));
  ReadOptions options;
  options.levels = 1;
  const Cloud coarse = read_part(file, options);
  EXPECT_TRUE(coarse.warnings.empty());  // counts and bounds are those of the part
  EXPECT_TRUE(coarse.positions == std::vector<Vec3>(whole.positions.begin(), whole.positions.begin() + 5));
  EXPECT_EQ(samples::read(samples::written(coarse, "a.las")).positions, coarse.positions);
  options.levels = 2;
  EXPECT_EQ(read_part(file, options).positions, whole.positions);
  options.levels = 0;
  options.box = Box{{-9, -9, -9}, {-0.5, 7, 9}};  // the child at -8, points 5, 6 and 7 of it
  const Cloud part = read_part(file, options);
  EXPECT_TRUE(part.positions == std::vector<Vec3>(whole.positions.begin() + 5, whole.positions.begin() + 8));
  EXPECT_EQ(samples::read(samples::written(part, "a.laz")).positions, part.positions);
  options.box = Box{{100, 100, 100}, {101, 101, 101}};
  EXPECT_THROW(read_part(file, options), InvalidInput);
  options.box = {};
  options.levels = 1;
  EXPECT_EQ(read_part(compressed(las_file(6, 18)), options).warnings.size(), 1U);  // no COPC
}

TEST(Copc, IsWrittenWithoutItsRecord) {
  const std::string las = samples::written(samples::read(samples::copc_file()), "a.las");
  EXPECT_EQ(las.substr(0, load_points_at(las)).find("copc"), std::string::npos);
  EXPECT_EQ(samples::read(samples::written(samples::read(samples::copc_file()), "a.laz")).format, "laz 1.4, point format 6");
}

TEST(Copc, DamageIsAnErrorOrFewerPoints) {
  const std::string file = samples::copc_file();
  ReadOptions options;
  options.levels = 1;
  options.box = Box{{-9, -99, -9}, {9, 99, 9}};
  int refused = 0;
  for (std::size_t at = 375; at < file.size(); at += at < 640 || at > file.size() - 200 ? 1 : 7) {
    for (const char byte : {'\0', '\xFF', '\x7F', static_cast<char>(file[at] ^ 1)}) {
      std::string damaged = file;
      damaged[at] = byte;
      try {
        EXPECT_LE(read_part(damaged, options).positions.size(), 18U) << at;
      } catch (const InvalidInput&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
  std::string circle = file;  // the page that refers to itself
  put(circle, circle.size() - 128 + 32 + 16, std::uint64_t{circle.size() - 128});
  options.levels = 0;
  EXPECT_THROW(read_part(circle, options), InvalidInput);
}

TEST(Ept, CellsOfLazAreOneCloud) {
  const Folder folder;
  for (const char* name : {"ept-hierarchy", "ept-data"}) std::filesystem::create_directories(folder.path(name));
  samples::spill(folder.path("ept.json"), R"({"bounds":[-1e7,-1e7,-1e7,1e7,1e7,1e7],"dataType":"laszip","schema":[]})");
  samples::spill(folder.path("ept-hierarchy/0-0-0-0.json"), R"({"0-0-0-0": 20, "1-0-0-0": 30})");
  samples::spill(folder.path("ept-data/0-0-0-0.laz"), compressed(las_file(7, 20)));
  samples::spill(folder.path("ept-data/1-0-0-0.laz"), compressed(las_file(7, 30)));
  const Cloud cloud = read_cloud(folder.path(""));
  EXPECT_EQ(cloud.format, "ept, 2 cells of LAZ");
  EXPECT_EQ(cloud.positions.size(), 50U);
  EXPECT_EQ(cloud.positions[20], samples::read(las_file(7, 30)).positions[0]);
  EXPECT_EQ(cloud.colors.size(), 50U);
  merge_checks::expect_what_write_cloud_writes(folder.path(""), io::ept_files(folder.path("ept.json")));
  samples::spill(folder.path("ept-hierarchy/0-0-0-0.json"), R"({"0-0-0-0": 21})");
  EXPECT_THROW((void)read_cloud(folder.path("")), InvalidInput);
}

TEST(Laz, IsAStreamOfTheSamePoints) {
  const Folder folder;
  const std::string path = folder.path("a.laz");
  for (const unsigned format : {1U, 3U, 6U, 8U}) {
    for (const std::uint32_t chunk : {50000U, 7U, kAnyChunks}) {
      samples::spill(path, compressed(las_file(format, 200, true), chunk));
      stream_checks::expect_what_read_cloud_gives(path);
    }
  }
  samples::spill(path, samples::copc_file());
  stream_checks::expect_what_read_cloud_gives(path);
}

TEST(Laz, TilesWriteWhatWriteCloudWrites) {
  const Folder folder;
  const std::string path = folder.path("a.laz");
  const std::string rest = std::string(60, '\0') + "after the points";
  for (const unsigned format : {1U, 3U, 4U, 6U, 8U}) {
    for (const bool extra : {false, true}) {
      const std::string las = las_file(format, 60, extra, format == 3 || format == 6 ? rest : "");
      for (const std::string& bytes : {las, compressed(las, 7)}) {
        samples::spill(path, bytes);
        merge_checks::expect_what_write_cloud_writes(path, {path});
      }
    }
  }
  samples::spill(path, samples::copc_file());
  merge_checks::expect_what_write_cloud_writes(path, {path});
  samples::spill(folder.path("b.las"), las_file(7, 30));
  merge_checks::expect_what_write_cloud_writes(folder.path(""), {path, folder.path("b.las")});
}

TEST(Laz, ManyPointsAreWrittenWithoutBeingHeld) {
  constexpr std::size_t kMany = 200'000;  // four chunks, that pack to 4 MiB
  const Folder folder;
  const std::string path = folder.path("a.las");
  write_cloud(path, samples::helix(kMany), nullptr, nullptr);
  const Cloud cloud = read_cloud(path);
  allocator::reset_peak();
  const std::size_t before = allocator::live.load();
  write_cloud(folder.path("b.laz"), cloud, nullptr, nullptr);
  EXPECT_LT(allocator::peak.load() - before, std::filesystem::file_size(folder.path("b.laz")));
  EXPECT_TRUE(unpacked(samples::slurp(folder.path("b.laz"))) == samples::slurp(path));
}

TEST(Laz, DamageInAStreamIsWhatItIsInTheWholeFile) {
  const Folder folder;
  const std::string path = folder.path("a.laz");
  const std::string good = compressed(las_file(6, 60), 20);
  std::mt19937 random(3);
  constexpr int kTries = 150;
  for (int i = 0; i < kTries; ++i) {
    std::string bad = good;
    if (i % 3 == 0) {
      bad.resize(random() % good.size());
    } else {
      bad[random() % bad.size()] = static_cast<char>(random());
    }
    samples::spill(path, bad);
    try {
      (void)stream_checks::streamed(path);
      stream_checks::expect_what_read_cloud_gives(path);
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
      EXPECT_THROW((void)read_cloud(path), InvalidInput) << error.what();
    }
  }
}

TEST(Laz, CutAnywhereIsAnError) {
  for (const unsigned format : {1U, 7U}) {
    const std::string laz = compressed(las_file(format, 200, true), 50);
    for (std::size_t size = 0; size < laz.size(); ++size) EXPECT_THROW(samples::read(laz.substr(0, size)), InvalidInput) << size;
  }
}

// Memory beside the points: LASzip's models of one chunk, which a small file needs too.
constexpr std::size_t kModels = std::size_t{8} << 20;

// An error, or as many points; and no memory because a number in the file says so.
void expect_harmless(const std::string& laz, std::size_t count, const std::string& what) {
  allocator::reset_peak();
  const std::size_t before = allocator::live;
  try {
    EXPECT_EQ(samples::read(laz).positions.size(), count) << what;
  } catch (const InvalidInput&) {
  }
  EXPECT_LE(allocator::peak - before, 256 * 4 * laz.size() + kModels) << what;
}

TEST(Laz, DamageIsAnErrorOrLeavesTheCount) {
  constexpr std::size_t kPoints = 60;
  // Every chunk takes LASzip a while, so that not every bit has its turn; the steps meet every bit of a byte.
  constexpr std::size_t kBitStep = kSanitized ? 1601 : 61;
  constexpr std::size_t kWordStep = kSanitized ? 601 : 23;
  for (const unsigned format : {1U, 3U, 6U, 10U}) {
    const std::string las = las_file(format, kPoints, true);
    for (const std::uint32_t chunk : {50000U, format >= 6 ? kAnyChunks : 25U}) {
      const std::string laz = compressed(las, chunk);
      for (std::size_t bit = 0; bit < 8 * laz.size(); bit += kBitStep) {
        std::string damaged = laz;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        expect_harmless(damaged, kPoints, "format " + std::to_string(format) + ", bit " + std::to_string(bit));
      }
      for (std::size_t at = 0; at + 4 <= laz.size(); at += kWordStep) {
        for (const std::uint32_t word : {0U, 0xFFFFFFFFU, 0x7FFFFFFFU}) {
          std::string damaged = laz;
          put(damaged, at, word);
          expect_harmless(damaged, kPoints, "format " + std::to_string(format) + ", word at " + std::to_string(at));
        }
      }
    }
  }
}

TEST(Laz, RandomCompressedBytesAreHarmless) {
  constexpr std::size_t kPoints = 300;
  constexpr int kRuns = kSanitized ? 20 : 400;
  std::mt19937 random(1);
  for (const unsigned format : {0U, 3U, 5U, 7U, 10U}) {
    const std::string laz = compressed(las_file(format, kPoints, true));
    const std::size_t begin = io::read_las_header({laz, "sample"}).points_at + 8;
    for (int run = 0; run < kRuns; ++run) {
      std::string damaged = laz;
      for (int change = 0; change <= run % 8; ++change) {
        damaged[begin + random() % (laz.size() - begin)] = static_cast<char>(random());
      }
      expect_harmless(damaged, kPoints, "format " + std::to_string(format) + ", run " + std::to_string(run));
    }
  }
}

TEST(Laz, WhatCannotBeReadIsSaid) {
  const std::string las = las_file(3, 100);
  const std::string laz = compressed(las);
  const io::LasHeader header = io::read_las_header({laz, "sample"});
  std::string changed = laz;
  changed[header.laszip_vlr + io::las::kVlrHeader] = 1;
  EXPECT_NE(message_of(changed).find("convert it"), std::string::npos);
  changed = las;
  changed[io::las::kPointFormat] = static_cast<char>(3 | 0x80);
  EXPECT_NE(message_of(changed).find("without the record"), std::string::npos);
  changed = laz;
  put(changed, io::las::kLegacyCount, std::uint32_t{0});
  put(changed, io::las::kCount, std::uint64_t{1} << 40);
  EXPECT_NE(message_of(changed).find("more than 256 times"), std::string::npos);
}

TEST(Laz, WhatLaszipWarnsOfIsNotPrinted) {
  testing::internal::CaptureStderr();
  LASMessage(LAS_WARNING, "as where %d bytes may lack", 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace g3r
