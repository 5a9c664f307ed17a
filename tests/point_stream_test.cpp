// Files as streams of points: what they return is what the readers of whole files give, and what is merged is what write_cloud() writes.
#include "counting_allocator.h"
#include "io/laz.h"
#include "io_samples.h"
#include "merge_checks.h"
#include "stream_checks.h"

#include <g3r/io.h>

#include <gtest/gtest.h>

#include <random>

namespace g3r {
namespace {

using merge_checks::expect_what_write_cloud_writes;
using samples::Folder;
using samples::spill;
using stream_checks::expect_what_read_cloud_gives;
using stream_checks::kAtOnce;
using stream_checks::refusal_of_read_cloud;
using stream_checks::streamed;

TEST(PointStream, HandsOutThePointsAndRecordsOfEveryFormat) {
  const Folder folder;
  for (const samples::Sample& sample : samples::all(23)) {
    spill(folder.path(sample.name), sample.bytes);
    expect_what_read_cloud_gives(folder.path(sample.name));
  }
}

TEST(PointStream, TruncatedFilesAreErrorsThatNameThem) {
  const Folder folder;
  for (const samples::Sample& sample : samples::all(23)) {
    if (!sample.counted || sample.name.starts_with("mesh")) continue;
    spill(folder.path(sample.name), sample.bytes.substr(0, sample.bytes.size() * 2 / 3));
    try {
      (void)streamed(folder.path(sample.name));
      ADD_FAILURE() << sample.name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(sample.name), std::string::npos) << error.what();
    }
  }
}

TEST(PointStream, HeadersLongerThanWhatIsReadFirstAreWhole) {
  const Folder folder;
  const std::string filler = "comment " + std::string(1 << 16, '-') + "\n";  // beyond what a format is told by
  const auto with = [&](const std::string& bytes, const std::string& line, const std::string& first) {
    const std::size_t at = bytes.find('\n') + 1;
    return bytes.substr(0, at) + line + first + bytes.substr(at);
  };
  for (const samples::Sample& sample : samples::all(23)) {
    if (sample.bytes.starts_with("ply\n")) {
      spill(folder.path(sample.name), with(sample.bytes, "comment end_header\n", filler));
    } else if (sample.bytes.starts_with("# .PCD")) {
      spill(folder.path(sample.name), with(sample.bytes, "# DATA binary\n", "# " + filler));
    } else {
      continue;
    }
    expect_what_read_cloud_gives(folder.path(sample.name));
  }
}

TEST(PointStream, MemoryDoesNotDependOnTheSizeOfTheFile) {
  constexpr std::size_t kMany = 150'000;  // of 5.5 MiB and more in every format but LAZ
  constexpr std::size_t kMostBytes = std::size_t{5}
                                     << 20;  // a block of 1 MiB as in the file, as in the table and as points, or a LAZ chunk
  const Folder folder;
  const Cloud cloud = samples::helix(kMany);
  for (const char* name : {"a.ply", "a.las", "a.laz", "a.npy", "a.pcd", "a.csv", "a.pts", "a.xyz", "a.ptx", "a.asc"}) {
    if (name == std::string("a.laz") && !io::laz_is_compiled()) continue;
    if (name == std::string("a.ptx")) {
      spill(folder.path(name), samples::ptx(kMany * 3 / 5));  // of the first of its two scans a third is left out
    } else if (name == std::string("a.asc")) {
      std::string grid = "ncols 1000\nnrows " + std::to_string(kMany / 1000) + "\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
      for (std::size_t i = 0; i < kMany; ++i) grid += "0.1000000000000000055511151231257827021" + std::string(i % 1000 == 999 ? "\n" : " ");
      spill(folder.path(name), grid);
    } else {
      write_cloud(folder.path(name), cloud, nullptr, nullptr);
    }
    allocator::reset_peak();
    const std::size_t before = allocator::live.load();
    const auto stream = io::open_points(folder.path(name), true);
    std::vector<Vec3> points;
    std::string records;
    std::size_t count = 0;
    for (stream->next(kAtOnce, points, &records); !points.empty(); stream->next(1000, points, &records)) count += points.size();
    EXPECT_EQ(count, kMany) << name;
    EXPECT_LT(allocator::peak.load() - before, kMostBytes) << name;
  }
}

// Three columns, more, names, words, counts, two scans: every kind of text.
std::vector<samples::Sample> texts(std::size_t count) {
  std::vector<samples::Sample> found;
  std::string named = "id;label;x;y;z;i\r\n";
  std::string pnezd;
  std::string words;
  std::string triples;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string n = std::to_string(i);
    named += n + ";wall " + n + ";0.5;" + n + ";1e3;" + std::to_string(i % 9) + "\r\n";
    pnezd += std::to_string(i * 7 % count + 1) + ",5000.5," + n + ",7.25,GND\n";
    words += "0.5 " + n + " 1 a 0 0 1 255 0 " + std::to_string(i % 256) + " b\r";
    triples += "1 2 " + n + " " + std::to_string(i % 256) + " 2 3 0.6 0 0.8 9.5\n";
  }
  found.push_back({"named.csv", named, 0, false});
  found.push_back({"pnezd.txt", pnezd, 0, false});
  found.push_back({"words.xyz", words, 0, false});  // lines end with CR
  found.push_back({"triples.xyz", "\xef\xbb\xbf" + triples, 0, false});
  found.push_back({"a.pts", std::to_string(count) + "\n" + triples + std::to_string(count) + "\n" + triples, 0, true});
  for (const samples::Sample& sample : samples::all(count)) {
    const std::string& name = sample.name;
    if (name.ends_with(".xyz") || name.ends_with(".csv") || name.ends_with(".pts") || name.ends_with(".ptx") || name.ends_with(".asc"))
      found.push_back(sample);
  }
  return found;
}

TEST(TextStream, HandsOutThePointsAndRecordsOfEveryText) {
  const Folder folder;
  for (const std::size_t count : {23U, 4000U}) {
    for (const samples::Sample& sample : texts(count)) {
      spill(folder.path(sample.name), sample.bytes);
      expect_what_read_cloud_gives(folder.path(sample.name));
    }
  }
}

TEST(TextStream, LinesThatPiecesCutAreWhole) {
  const Folder folder;
  for (const char* end : {"\n", "\r", "\r\n"}) {
    std::string text;
    for (int i = 0; i < 60'000; ++i) text += std::to_string(i) + " 0.125 " + std::to_string(i % 10) + end;
    spill(folder.path("a.xyz"), text);
    expect_what_read_cloud_gives(folder.path("a.xyz"));
  }
}

TEST(TextStream, DamageIsWhatItIsInTheWholeFile) {
  const Folder folder;
  std::mt19937 random(5);
  constexpr int kTries = 300;
  int refused = 0;
  for (const samples::Sample& sample : texts(40)) {
    const std::string path = folder.path(sample.name);
    for (int i = 0; i < kTries / 10; ++i) {
      std::string bad = sample.bytes;
      if (i % 3 == 0) {
        bad.resize(random() % bad.size());
      } else {
        bad[random() % bad.size()] = "x, ;9\n\0-"[random() % 8];
      }
      spill(path, bad);
      const std::string message = refusal_of_read_cloud(path);
      try {
        (void)streamed(path);
        EXPECT_EQ(message, "") << bad;
        expect_what_read_cloud_gives(path);
      } catch (const InvalidInput& error) {
        ++refused;
        EXPECT_EQ(error.what(), message) << bad;
        EXPECT_NE(message.find(path), std::string::npos);
      }
    }
  }
  EXPECT_GT(refused, kTries / 10);
}

TEST(TextStream, ALineWithoutAnEndIsRefused) {
  const Folder folder;
  spill(folder.path("a.xyz"), "1 2 3\n1 2 " + std::string(std::size_t{17} << 20, '3'));
  try {
    (void)streamed(folder.path("a.xyz"));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("a.xyz: line 2: more than 16 MiB without a line end"), std::string::npos) << error.what();
  }
}

TEST(TextStream, AFileThatShrinksIsAnError) {
  const Folder folder;
  spill(folder.path("a.xyz"), "1 2 3\n4 5 6\n");
  const auto stream = io::open_points(folder.path("a.xyz"));
  spill(folder.path("a.xyz"), "1 2 3\n");
  std::vector<Vec3> points;
  EXPECT_THROW(stream->next(9, points), Error);
}

TEST(PointWriter, WritesWhatWriteCloudWritesOfOneFile) {
  const Folder folder;
  for (const samples::Sample& sample : samples::all(23)) {
    if (sample.name.starts_with("mesh") || sample.name == "big_endian.ply") continue;  // elements beside the points are not kept
    if (sample.name.starts_with("splats")) continue;                                   // colours that no property holds are not
    spill(folder.path(sample.name), sample.bytes);
    expect_what_write_cloud_writes(folder.path(sample.name), {folder.path(sample.name)});
  }
}

TEST(PointWriter, WritesWhatWriteCloudWritesOfEveryText) {
  const Folder folder;
  for (const samples::Sample& sample : texts(23)) {
    spill(folder.path(sample.name), sample.bytes);
    expect_what_write_cloud_writes(folder.path(sample.name), {folder.path(sample.name)});
  }
}

TEST(PointWriter, LasIsRefusedForPointsThatAreNotFinite) {
  const Folder folder;
  tiles::Manifest manifest;
  manifest.inputs.push_back({"a.ply", 0, 1});
  manifest.non_finite = 3;
  const Monitor monitor;
  Stages stages(monitor);
  try {
    tiles::PointWriter::check(folder.path("out.ply"), manifest);
    const tiles::PointWriter writer(folder.path("out.las"), manifest, stages);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("out.las: LAS cannot hold"), std::string::npos) << error.what();
  }
  EXPECT_EQ(folder.files(), 0U);
}

TEST(PointWriter, WritesWhatWriteCloudWritesOfAFolder) {
  const Folder folder;
  spill(folder.path("a.ply"), samples::written(samples::helix(23), "a.ply"));
  write_cloud(folder.path("b.las"), samples::helix(300), nullptr, nullptr);
  spill(folder.path("c.csv"), "x,y,z,intensity\n1,2,3,0.5\n4,5,6,7\n");
  Cloud black = samples::helix(9, Scalar::kFloat32);
  for (auto& color : black.colors) color = {};
  write_cloud(folder.path("d.ply"), black, nullptr, nullptr);
  std::vector<std::string> inputs;
  for (const char* name : {"a.ply", "b.las", "c.csv", "d.ply"}) inputs.push_back(folder.path(name));
  expect_what_write_cloud_writes(folder.path(""), inputs);
  write_cloud(folder.path("e.las"), read_cloud_bytes("x y z red green blue\n1 2 3 40000 300 0\n", 39, "a.txt"), nullptr, nullptr);
  inputs.push_back(folder.path("e.las"));
  spill(folder.path("f.csv"), "x,y,z,r,g,b,quality\n1,2,3,0.1,0.5,1,7\n");
  inputs.push_back(folder.path("f.csv"));
  expect_what_write_cloud_writes(folder.path(""), inputs);  // colours of 16 bits
}

TEST(PointWriter, KeepsTheCommentsOfOnePly) {
  const Folder folder;
  const std::string bytes = samples::written(samples::helix(9), "a.ply");
  const std::size_t at = bytes.find("element");
  for (const char* name : {"a.ply", "b.ply"})
    spill(folder.path(name), bytes.substr(0, at) + "comment offset 5 6 7\nobj_info kept\n" + bytes.substr(at));
  expect_what_write_cloud_writes(folder.path("a.ply"), {folder.path("a.ply")});
  expect_what_write_cloud_writes(folder.path(""), {folder.path("a.ply"), folder.path("b.ply")});
}

}  // namespace
}  // namespace g3r
