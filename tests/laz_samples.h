// LAS files of every point format, and LAZ files compressed from them with LASzip's encoder.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <bytestreamout_array.hpp>
#include <laswritepoint.hpp>
#include <laszip.hpp>

#include "io/las.h"
#include "io_samples.h"

namespace g3r::samples {

inline constexpr std::uint32_t kAnyChunks = 0xFFFFFFFF;

inline void require_done(bool done) {
  if (!done) throw std::runtime_error("LASzip cannot compress the sample");
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

inline std::string vlr(const std::string& user, unsigned record, const std::string& data) {
  std::string bytes(io::las::kVlrHeader, '\0');
  bytes.replace(2, user.size(), user);
  put(bytes, 18, static_cast<std::uint16_t>(record));
  put(bytes, 20, static_cast<std::uint16_t>(data.size()));
  return bytes + data;
}

inline std::string described(const std::string& name, char type) {
  std::string bytes(io::las::kDescriptor, '\0');
  bytes[2] = type;
  bytes.replace(4, name.size(), name);
  return bytes;
}

// LAS 1.4 with every field in use: coordinates and time walk, the other bytes stay or take any value. With `extra`: an extra u8 and u16.
inline std::string las_file(unsigned format, std::size_t count, bool extra = false, const std::string& after_points = "") {
  constexpr std::size_t kHeader = 375;
  std::string las(kHeader, '\0');
  las.replace(0, 4, "LASF");
  las[24] = 1;
  las[io::las::kMinor] = 4;
  put(las, io::las::kHeaderSize, static_cast<std::uint16_t>(kHeader));
  las[io::las::kPointFormat] = static_cast<char>(format);
  const std::size_t record_bytes = io::las::kRecordSize[format] + (extra ? 3 : 0);
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
inline std::array<unsigned char, 128> point14(const char* record) {
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

// LASzip's compression of a LAS file. Chunks of `chunk` points, or with kAnyChunks of 5, 6, 7, ... points; `ends` gets the places of their
// ends.
inline std::string compressed(const std::string& las, std::uint32_t chunk = 50000, unsigned version = 0,
                              std::vector<std::uint64_t>* ends = nullptr) {
  const io::LasHeader header = io::read_las_header({las, "sample"});
  const bool layered = header.point_format >= 6;
  LASzip how;
  require_done(how.setup(static_cast<U8>(header.point_format), static_cast<U16>(header.record_bytes),
                         layered ? LASZIP_COMPRESSOR_LAYERED_CHUNKED : LASZIP_COMPRESSOR_CHUNKED));
  how.set_chunk_size(chunk);
  how.request_version(static_cast<U16>(version != 0 ? version : layered ? 3 : 2));
  U8* how_bytes = nullptr;
  I32 how_size = 0;
  require_done(how.pack(how_bytes, how_size));
  const std::string record =
      vlr("laszip encoded", io::las::kCompression, std::string(reinterpret_cast<char*>(how_bytes), static_cast<std::size_t>(how_size)));

  ByteStreamOutArrayLE stream;
  std::string laz = las.substr(0, header.points_at) + record;
  laz[io::las::kPointFormat] = static_cast<char>(header.point_format | 0x80U);
  put(laz, io::las::kVlrCount, header.vlr_count + 1);
  put(laz, io::las::kPointsAt, static_cast<std::uint32_t>(laz.size()));
  stream.putBytes(reinterpret_cast<const U8*>(laz.data()), static_cast<U32>(laz.size()));
  LASwritePoint writer;
  require_done(writer.setup(how.num_items, how.items, &how));
  require_done(writer.init(&stream));
  std::size_t chunk_end = 5;
  for (std::size_t i = 0, length = 5; i < header.count; ++i) {
    const char* point = las.data() + header.points_at + i * header.record_bytes;
    const std::array<unsigned char, 128> first = layered ? point14(point) : std::array<unsigned char, 128>{};
    std::vector<const U8*> items;
    for (std::size_t k = 0; k < how.num_items; point += how.items[k++].size) items.push_back(reinterpret_cast<const U8*>(point));
    if (layered) items[0] = first.data();
    require_done(writer.write(items.data()));
    if (chunk == kAnyChunks && i + 1 == chunk_end) {
      require_done(writer.chunk());
      if (ends != nullptr) ends->push_back(static_cast<std::uint64_t>(stream.getSize()));
      chunk_end += ++length;
    }
  }
  require_done(writer.done());
  const std::string rest = las.substr(header.points_at + header.count * header.record_bytes);
  laz.assign(reinterpret_cast<const char*>(stream.getData()), static_cast<std::size_t>(stream.getSize()));
  if (!rest.empty()) put(laz, io::las::kEvlrAt, std::uint64_t{laz.size()});
  return laz + rest;
}

inline std::uint32_t load_points_at(const std::string& las) { return io::load<std::uint32_t>(las.data() + io::las::kPointsAt); }

// A COPC file of three chunks of 5, 6 and 7 points: the root of an octree of the cube -8..8, and its children at -8 and at 0 along x, of
// which the hierarchy has a page of its own.
inline std::string copc_file() {
  constexpr std::size_t kHeader = 375;
  std::string las = las_file(6, 18);
  const std::string info = vlr("copc", 1, std::string(160, '\0'));
  las.insert(kHeader, info);
  put(las, io::las::kVlrCount, std::uint32_t{2});
  put(las, io::las::kPointsAt, static_cast<std::uint32_t>(load_points_at(las) + info.size()));
  const std::array<std::array<std::int32_t, 3>, 18> places = [] {
    std::array<std::array<std::int32_t, 3>, 18> all{};
    for (std::int32_t i = 0; i < 18; ++i) all[static_cast<std::size_t>(i)] = {i < 5 ? i : i < 11 ? -i : i - 10, i, -i / 4};
    return all;
  }();
  const std::size_t points_at = load_points_at(las);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) put(las, points_at + i * io::las::kRecordSize[6] + 4 * a, places[i][a] * 1000);
  }
  for (std::size_t a = 0; a < 3; ++a) put(las, io::las::kOffset + 8 * a, 0.0);
  std::vector<std::uint64_t> ends;
  std::string laz = compressed(las, kAnyChunks, 0, &ends);
  const std::uint64_t first = load_points_at(laz) + 8;
  const auto entry = [](std::int32_t level, std::int32_t x, std::uint64_t at, std::uint64_t bytes, std::int32_t count) {
    return raw(level) + raw(x) + raw(std::int32_t{0}) + raw(std::int32_t{0}) + raw(at) + raw(static_cast<std::int32_t>(bytes)) + raw(count);
  };
  const std::uint64_t page = laz.size() + 60;
  std::string pages = entry(0, 0, first, ends[0] - first, 5) + entry(1, 0, page + 64, 64, -1);
  pages += entry(1, 0, ends[0], ends[1] - ends[0], 6) + entry(1, 1, ends[1], ends[2] - ends[1], 7);
  std::string evlr(60, '\0');
  evlr.replace(2, 4, "copc");
  put(evlr, 18, std::uint16_t{1000});
  put(evlr, 20, std::uint64_t{pages.size()});
  put(laz, io::las::kEvlrAt, std::uint64_t{laz.size()});
  put(laz, io::las::kEvlrCount, std::uint32_t{1});
  put(laz, kHeader + 54 + 24, 8.0);  // half side
  put(laz, kHeader + 54 + 40, page);
  put(laz, kHeader + 54 + 48, std::uint64_t{64});
  return laz + evlr + pages;
}

}  // namespace g3r::samples
