// LAZ against LAS: files compressed here with LASzip's encoder.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include <bytestreamout_array.hpp>
#include <laswritepoint.hpp>
#include <laszip.hpp>

#include "counting_allocator.h"
#include "io/laz.h"
#include "io/table.h"
#include "io_samples.h"
#include "sanitized.h"

// LASzip's encoder keeps its list of chunks of different sizes for ever.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer's name
extern "C" const char* __lsan_default_suppressions() { return "leak:LASwritePoint::add_chunk_to_table\n"; }

namespace g3r {
namespace {

using io::las::kRecordSize;
using samples::raw;

constexpr std::uint32_t kAnyChunks = 0xFFFFFFFF;

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::string vlr(const std::string& user, unsigned record, const std::string& data) {
  std::string bytes(io::las::kVlrHeader, '\0');
  bytes.replace(2, user.size(), user);
  put(bytes, 18, static_cast<std::uint16_t>(record));
  put(bytes, 20, static_cast<std::uint16_t>(data.size()));
  return bytes + data;
}

std::string described(const std::string& name, char type) {
  std::string bytes(io::las::kDescriptor, '\0');
  bytes[2] = type;
  bytes.replace(4, name.size(), name);
  return bytes;
}

// LAS 1.4 with every field in use: coordinates and time walk, the other bytes stay or take any value. With `extra`: an extra u8 and u16.
std::string las_file(unsigned format, std::size_t count, bool extra = false, const std::string& after_points = "") {
  constexpr std::size_t kHeader = 375;
  std::string las(kHeader, '\0');
  las.replace(0, 4, "LASF");
  las[24] = 1;
  las[io::las::kMinor] = 4;
  put(las, io::las::kHeaderSize, static_cast<std::uint16_t>(kHeader));
  las[io::las::kPointFormat] = static_cast<char>(format);
  const std::size_t record_bytes = kRecordSize[format] + (extra ? 3 : 0);
  put(las, io::las::kRecordBytes, static_cast<std::uint16_t>(record_bytes));
  if (format < 6) put(las, io::las::kLegacyCount, static_cast<std::uint32_t>(count));
  put(las, io::las::kCount, std::uint64_t{count});
  las += vlr("somebody", 7, "kept");
  if (extra) las += vlr("LASF_Spec", io::las::kExtraBytes, described("echo", 1) + described("range", 3));
  put(las, io::las::kVlrCount, std::uint32_t{extra ? 2U : 1U});
  put(las, io::las::kPointsAt, static_cast<std::uint32_t>(las.size()));
  std::mt19937 random(format);
  const auto below = [&](std::uint32_t n) { return static_cast<std::int32_t>(random() % n); };
  std::string record(record_bytes, '\0');
  std::array<std::int32_t, 3> at{500000, -5400000, 2000000000};
  std::array<std::int32_t, 3> low{}, high{};
  double time = 1e8;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t b = 12; b < record_bytes; ++b) {
      if (below(8) == 0) record[b] = static_cast<char>(below(256));
    }
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] += below(2001) - 1000;
      put(record, 4 * a, at[a]);
      low[a] = i == 0 ? at[a] : std::min(low[a], at[a]);
      high[a] = i == 0 ? at[a] : std::max(high[a], at[a]);
    }
    time += 1e-4 * below(3);
    if (format >= 6) put(record, 22, time);
    if (format == 1 || (format >= 3 && format < 6)) put(record, 20, time);
    las += record;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    put(las, io::las::kScale + 8 * a, 0.001);
    put(las, io::las::kOffset + 8 * a, 1000.0);
    put(las, io::las::kBounds + 16 * a, high[a] * 0.001 + 1000.0);
    put(las, io::las::kBounds + 16 * a + 8, low[a] * 0.001 + 1000.0);
  }
  if (!after_points.empty()) {
    put(las, io::las::kEvlrAt, std::uint64_t{las.size()});
    put(las, io::las::kEvlrCount, std::uint32_t{1});
  }
  return las + after_points;
}

// The layout in which LASzip takes the first item of point formats 6 to 10.
std::array<unsigned char, 128> point14(const char* record) {
  std::array<unsigned char, 128> item{};
  const auto* from = reinterpret_cast<const unsigned char*>(record);
  std::copy_n(from, 14, item.begin());
  item[14] = from[15] & 0xC0;
  item[15] = static_cast<unsigned char>((from[16] < 32 ? from[16] : 0) | from[15] << 5);
  item[17] = from[17];
  std::copy_n(from + 20, 2, item.begin() + 18);
  std::copy_n(from + 18, 2, item.begin() + 20);
  item[22] = static_cast<unsigned char>(1 | (from[15] >> 4 & 3) << 2 | from[15] << 4);
  item[23] = from[16];
  item[24] = from[14];
  std::copy_n(from + 22, 8, item.begin() + 32);
  return item;
}

// LASzip's compression of a LAS file. Chunks of `chunk` points, or with kAnyChunks of 5, 6, 7, ... points.
std::string compressed(const std::string& las, std::uint32_t chunk = 50000, unsigned version = 0) {
  const io::LasHeader header = io::read_las_header({las, "sample"});
  const bool layered = header.point_format >= 6;
  LASzip how;
  EXPECT_TRUE(how.setup(static_cast<U8>(header.point_format), static_cast<U16>(header.record_bytes),
                        layered ? LASZIP_COMPRESSOR_LAYERED_CHUNKED : LASZIP_COMPRESSOR_CHUNKED));
  how.set_chunk_size(chunk);
  how.request_version(static_cast<U16>(version != 0 ? version : layered ? 3 : 2));
  U8* how_bytes = nullptr;
  I32 how_size = 0;
  EXPECT_TRUE(how.pack(how_bytes, how_size));
  const std::string record =
      vlr("laszip encoded", io::las::kCompression, std::string(reinterpret_cast<char*>(how_bytes), static_cast<std::size_t>(how_size)));

  ByteStreamOutArrayLE stream;
  std::string laz = las.substr(0, header.points_at) + record;
  laz[io::las::kPointFormat] = static_cast<char>(header.point_format | 0x80U);
  put(laz, io::las::kVlrCount, header.vlr_count + 1);
  put(laz, io::las::kPointsAt, static_cast<std::uint32_t>(laz.size()));
  stream.putBytes(reinterpret_cast<const U8*>(laz.data()), static_cast<U32>(laz.size()));
  LASwritePoint writer;
  EXPECT_TRUE(writer.setup(how.num_items, how.items, &how));
  EXPECT_TRUE(writer.init(&stream));
  std::size_t chunk_end = 5;
  for (std::size_t i = 0, length = 5; i < header.count; ++i) {
    const char* point = las.data() + header.points_at + i * header.record_bytes;
    const std::array<unsigned char, 128> first = layered ? point14(point) : std::array<unsigned char, 128>{};
    std::vector<const U8*> items;
    for (std::size_t k = 0; k < how.num_items; point += how.items[k++].size) items.push_back(reinterpret_cast<const U8*>(point));
    if (layered) items[0] = first.data();
    EXPECT_TRUE(writer.write(items.data()));
    if (chunk == kAnyChunks && i + 1 == chunk_end) {
      EXPECT_TRUE(writer.chunk());
      chunk_end += ++length;
    }
  }
  EXPECT_TRUE(writer.done());
  const std::string rest = las.substr(header.points_at + header.count * header.record_bytes);
  laz.assign(reinterpret_cast<const char*>(stream.getData()), static_cast<std::size_t>(stream.getSize()));
  if (!rest.empty()) put(laz, io::las::kEvlrAt, std::uint64_t{laz.size()});
  return laz + rest;
}

std::string unpacked(const std::string& laz) {
  const io::Source source{laz, "sample"};
  return io::unpack_laz(source, io::read_las_header(source));
}

std::string message_of(const std::string& bytes) {
  try {
    samples::read(bytes);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Laz, EveryPointFormatUnpacksToTheBytesOfTheLasFile) {
  for (unsigned format = 0; format <= 10; ++format) {
    for (const bool extra : {false, true}) {
      const std::string las = las_file(format, 1000, extra);
      for (const std::uint32_t chunk : {50000U, 100U, 7U, kAnyChunks}) {
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
  constexpr std::size_t kBitStep = kSanitized ? 211 : 61;
  constexpr std::size_t kWordStep = kSanitized ? 83 : 23;
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
  constexpr int kRuns = kSanitized ? 60 : 400;
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

}  // namespace
}  // namespace g3r
