// Files as streams of points: what they hand out is what the readers of whole files give, and what is merged is what write_cloud() writes.
#include "counting_allocator.h"
#include "io/laz.h"
#include "io_samples.h"
#include "stream_checks.h"
#include "tiles/point_writer.h"

#include <g3r/io.h>

#include <gtest/gtest.h>

#include <cmath>

namespace g3r {
namespace {

using samples::Folder;
using samples::slurp;
using samples::spill;
using stream_checks::expect_what_read_cloud_gives;
using stream_checks::kAtOnce;
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
  constexpr std::size_t kMany = 300'000;  // of 11 MiB and more in every format but LAZ
  constexpr std::size_t kMostBytes = std::size_t{5}
                                     << 20;  // a block of 1 MiB as in the file, as in the table and as points, or a LAZ chunk
  const Folder folder;
  const Cloud cloud = samples::helix(kMany);
  for (const char* name : {"a.ply", "a.las", "a.laz", "a.npy", "a.pcd"}) {
    if (name == std::string("a.laz") && !io::laz_is_compiled()) continue;
    write_cloud(folder.path(name), cloud, nullptr, nullptr);
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

// The inputs as tiles::merge() writes them, with normals and confidence that count the points.
std::string merged(const std::vector<std::string>& inputs, const std::vector<Vec3>& normals, const std::vector<float>& confidence) {
  const Folder folder;
  tiles::Manifest manifest;
  for (const std::string& input : inputs) {
    const std::uint64_t points = io::open_points(input)->left();
    manifest.inputs.push_back({input, 0, points});
    manifest.points += points;
  }
  const Monitor monitor;
  Stages stages(monitor);
  tiles::PointWriter writer(folder.path("out.ply"), manifest, stages);
  std::size_t at = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto stream = io::open_points(inputs[i], true);
    std::vector<Vec3> points;
    std::string records;
    for (stream->next(kAtOnce, points, &records); !points.empty(); stream->next(kAtOnce, points, &records)) {
      const auto from = static_cast<std::ptrdiff_t>(at);
      const auto to = static_cast<std::ptrdiff_t>(at + points.size());
      writer.write(i, points, records, {normals.begin() + from, normals.begin() + to},
                   {confidence.begin() + from, confidence.begin() + to});
      at += points.size();
    }
  }
  writer.commit();
  return slurp(folder.path("out.ply"));
}

// `path` as read_cloud() takes it, which stands for the inputs.
void expect_what_write_cloud_writes(const std::string& path, const std::vector<std::string>& inputs) {
  const Cloud whole = read_cloud(path);
  std::vector<Vec3> normals;
  std::vector<float> confidence;
  for (std::size_t i = 0; i < whole.positions.size(); ++i) {
    normals.push_back({std::cos(static_cast<double>(i)), std::sin(static_cast<double>(i)), 0});
    confidence.push_back(static_cast<float>(i % 7) / 7);
  }
  const Folder folder;
  write_cloud(folder.path("whole.ply"), whole, &normals, &confidence);
  EXPECT_TRUE(slurp(folder.path("whole.ply")) == merged(inputs, normals, confidence)) << path;
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
}

}  // namespace
}  // namespace g3r
