// Small valid files of every format, cut at every byte and with every bit of their headers turned over; and readers under scarce memory.
#include <g3r/io.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <new>

#include "counting_allocator.h"
#include "io_samples.h"

namespace g3r {
namespace {

// The memory law: what a reader may hold beside the file itself.
constexpr std::size_t kTimesSize = 15;
constexpr std::size_t kConstant = std::size_t{1} << 20;

struct Outcome {
  bool refused = false;
  Cloud cloud;
};

// Reads from a copy of exactly the given length, so that a sanitizer sees every byte beyond it.
Outcome read_exactly(std::string_view bytes, const std::string& name) {
  Outcome outcome;
  const std::vector<char> copy(bytes.begin(), bytes.end());
  allocator::reset_peak();
  const std::size_t before = allocator::live;
  try {
    outcome.cloud = read_cloud_bytes(copy.data(), copy.size(), name);
  } catch (const InvalidInput& error) {
    outcome.refused = true;
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
  }
  EXPECT_LE(allocator::peak - before, kTimesSize * bytes.size() + kConstant) << name;
  return outcome;
}

bool is_prefix(const std::vector<Vec3>& part, const std::vector<Vec3>& whole) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

TEST(Truncation, GivesAnErrorAWarningOrTheSamePoints) {
  int cuts = 0;
  for (const samples::Sample& sample : samples::all()) {
    const std::vector<Vec3> whole = read_exactly(sample.bytes, sample.name).cloud.positions;
    for (std::size_t length = 0; length < sample.bytes.size(); ++length, ++cuts) {
      const Outcome cut = read_exactly(std::string_view(sample.bytes).substr(0, length), sample.name);
      if (cut.refused || cut.cloud.positions == whole || !cut.cloud.warnings.empty()) continue;
      // A format that does not say how many points follow cannot tell a file cut between two lines from a shorter one.
      const bool between_lines = !sample.counted && sample.bytes[length - 1] == '\n';
      EXPECT_TRUE(between_lines && is_prefix(cut.cloud.positions, whole)) << sample.name << " cut at " << length;
    }
  }
  RecordProperty("cuts", cuts);
}

TEST(BitFlip, InAHeaderNeverChangesTheCountSilently) {
  int bits = 0;
  for (const samples::Sample& sample : samples::all()) {
    const std::size_t count = read_exactly(sample.bytes, sample.name).cloud.positions.size();
    std::string bytes = sample.bytes;
    for (std::size_t at = 0; at < sample.header; ++at) {
      for (unsigned bit = 0; bit < 8; ++bit, ++bits) {
        bytes[at] = static_cast<char>(static_cast<unsigned char>(sample.bytes[at]) ^ 1U << bit);
        const Outcome flipped = read_exactly(bytes, sample.name);
        EXPECT_TRUE(flipped.refused || flipped.cloud.positions.size() == count || !flipped.cloud.warnings.empty())
            << sample.name << ", byte " << at << ", bit " << bit << ": " << flipped.cloud.positions.size() << " points";
      }
      bytes[at] = sample.bytes[at];
    }
  }
  RecordProperty("bits", bits);
}

TEST(BitFlip, AnywhereGivesAnErrorOrACloud) {
  int changes = 0;
  for (const samples::Sample& sample : samples::all(5)) {
    std::string bytes = sample.bytes;
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (const unsigned mask : {0x01U, 0x80U, 0xFFU}) {
        bytes[at] = static_cast<char>(static_cast<unsigned char>(sample.bytes[at]) ^ mask);
        ++changes;
        read_exactly(bytes, sample.name);
        try {
          (void)read_mesh_bytes(bytes.data(), bytes.size(), sample.name);
        } catch (const InvalidInput&) {
        }
      }
      bytes[at] = sample.bytes[at];
    }
  }
  RecordProperty("changes", changes);
}

TEST(Memory, LargerFilesKeepTheLawToo) {
  for (const samples::Sample& sample : samples::all(20000)) read_exactly(sample.bytes, sample.name);
}

TEST(Memory, FilesThatExpandMostKeepTheLaw) {
  const auto head = [](const char* type, std::size_t n) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(n) + "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) text += std::string("property ") + type + " " + name + "\n";
    return text + "end_header\n";
  };
  constexpr std::size_t kPoints = 300000;
  std::string ascii = head("double", kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) ascii += "1 2 3 4 5 6\n";
  EXPECT_FALSE(read_exactly(ascii, "ascii.ply").refused);
  std::string bytes = head("uchar", kPoints) + std::string(6 * kPoints, '\1');
  bytes.replace(bytes.find("ascii"), 5, "binary_little_endian");
  EXPECT_FALSE(read_exactly(bytes, "uchar.ply").refused);
  std::string lists =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nelement e 1\nproperty list int double "
      "d\nend_header\n1 2 3\n" +
      std::to_string(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) lists += " 1";
  EXPECT_FALSE(read_exactly(lists + "\n", "lists.ply").refused);
  std::string elements = "ply\nformat ascii 1.0\nelement vertex 0\nproperty char x\nproperty char y\nproperty char z\n";
  for (int i = 0; i < 20000; ++i) elements += "element " + std::to_string(i) + " 0\nproperty char x\n";
  EXPECT_FALSE(read_exactly(elements + "end_header\n", "elements.ply").refused);
  std::string xyz;
  for (std::size_t i = 0; i < kPoints; ++i) xyz += "1 2 3 4\n";
  EXPECT_FALSE(read_exactly(xyz, "four.xyz").refused);
  std::string grid = "ncols 1000\nnrows " + std::to_string(kPoints / 1000) + "\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  for (std::size_t i = 0; i < kPoints; ++i) grid += "1 ";
  EXPECT_EQ(read_exactly(grid, "ones.asc").cloud.positions.size(), kPoints);
  std::string json = R"({"asset":[)";
  for (std::size_t i = 0; i < kPoints; ++i) json += "0,";
  read_exactly(json + "0]}", "values.gltf");
}

TEST(Memory, AnyFailingAllocationIsBadAllocAndLeaksNothing) {
  int failures = 0;
  for (const samples::Sample& sample : samples::all(500)) {
    (void)read_exactly(sample.bytes, sample.name);  // what is allocated once for the whole program
    const std::size_t before = allocator::live;
    bool finished = false;
    for (long n = 0; !finished && n < 100000; ++n) {
      allocator::until_failure = n;
      try {
        (void)read_cloud_bytes(sample.bytes.data(), sample.bytes.size(), "cloud");
        finished = true;
      } catch (const std::bad_alloc&) {
        ++failures;
      }
      finished = finished && allocator::until_failure >= 0;
      allocator::until_failure = -1;
    }
    EXPECT_TRUE(finished) << sample.name;
    EXPECT_EQ(allocator::live, before) << sample.name;
  }
  RecordProperty("failures", failures);
}

TEST(Memory, AnyFailingAllocationOfAWriterLeavesNoFile) {
  const Cloud cloud = samples::read(samples::written(samples::helix(500), "a.ply"));
  int failures = 0;
  for (const char* name : {"a.ply", "a.pcd", "a.npy", "a.las", "a.xyz", "a.obj"}) {
    const samples::Folder folder;
    const std::string path = folder.path(name);
    bool finished = false;
    for (long n = 0; !finished && n < 100000; ++n) {
      allocator::until_failure = n;
      try {
        write_cloud(path, cloud, nullptr, nullptr);
        finished = true;
      } catch (const std::bad_alloc&) {
        ++failures;
      }
      allocator::until_failure = -1;
      EXPECT_EQ(folder.files(), finished ? 1U : 0U) << name;
    }
    EXPECT_TRUE(finished) << name;
  }
  RecordProperty("failures", failures);
}

}  // namespace
}  // namespace g3r
