#include "io/laz_codec.h"

#include <string>

namespace g3r::io {

using namespace las;

namespace {

constexpr std::size_t kPoint14 = 30;  // bytes of a record of format 6 or later before its other items
constexpr std::size_t kPoint14Layers = 9;

std::vector<LASitem> items_of(const LasHeader& header) {
  std::vector<LASitem> items;
  std::size_t at = 0;
  const auto add = [&](LASitem::Type type, std::size_t size) {
    items.push_back({type, static_cast<unsigned short>(size), 0});
    at += size;
  };
  const unsigned format = header.point_format;
  if (format < 6) {
    add(LASitem::POINT10, 20);
    if (format == 1 || format >= 3) add(LASitem::GPSTIME11, 8);
    if (format == 2 || format == 3 || format == 5) add(LASitem::RGB12, 6);
    if (format >= 4) add(LASitem::WAVEPACKET13, 29);
    if (at < header.record_bytes) add(LASitem::BYTE, header.record_bytes - at);
  } else {
    add(LASitem::POINT14, kPoint14);
    if (format == 7) add(LASitem::RGB14, 6);
    if (format == 8 || format == 10) add(LASitem::RGBNIR14, 8);
    if (format >= 9) add(LASitem::WAVEPACKET14, 29);
    if (at < header.record_bytes) add(LASitem::BYTE14, header.record_bytes - at);
  }
  return items;
}

bool known_version(LASitem::Type type, unsigned version) {
  if (type == LASitem::WAVEPACKET13) return version == 1;
  if (type >= LASitem::POINT14) return version == 3 || version == 4;
  return version == 1 || version == 2;
}

std::size_t layers_of(const LASitem& item) {
  if (item.type == LASitem::POINT14) return kPoint14Layers;
  if (item.type == LASitem::RGBNIR14) return 2;
  return item.type == LASitem::BYTE14 ? item.size : 1;
}

}  // namespace

// The record "laszip encoded": compressor, coder (u16), version (u8, u8, u16), options, size of chunks (u32), two u64 that are not used,
// the number of items (u16), and type, size, version (u16) of each.
LazCodec read_laz_codec(const Source& source, const LasHeader& header) {
  constexpr std::size_t kFixed = 34;
  constexpr std::size_t kItem = 6;
  if (header.laszip_vlr == 0)
    fail_at_byte(source, kVlrCount, "a LAZ file without the record \"laszip encoded\", which says how it is compressed");
  const std::size_t at = header.laszip_vlr + kVlrHeader;
  const char* bytes = source.bytes.data() + at;
  const auto length = load<std::uint16_t>(source.bytes.data() + header.laszip_vlr + 20);
  LazCodec codec;
  codec.items = items_of(header);
  const std::size_t wanted = kFixed + kItem * codec.items.size();
  if (length != wanted || load<std::uint16_t>(bytes + 32) != codec.items.size()) {
    fail_at_byte(source, at,
                 "the record that says how points are compressed does not go with point format " + std::to_string(header.point_format) +
                     " and records of " + std::to_string(header.record_bytes) + " bytes");
  }
  codec.compressor = load<std::uint16_t>(bytes);
  codec.chunk_points = load<std::uint32_t>(bytes + 12);
  const bool layered = header.point_format >= 6;
  if (codec.compressor != (layered ? 3U : 2U) || load<std::uint16_t>(bytes + 2) != 0 || codec.chunk_points == 0) {
    fail_at_byte(source, at,
                 "a kind of LAZ compression that g3r does not read (number " + std::to_string(codec.compressor) +
                     "); convert it, for example with \"laszip -i in.laz -o out.las\"");
  }
  for (std::size_t i = 0; i < codec.items.size(); ++i) {
    LASitem& item = codec.items[i];
    const char* stored = bytes + kFixed + kItem * i;
    item.version = load<std::uint16_t>(stored + 4);
    if (load<std::uint16_t>(stored) != item.type || load<std::uint16_t>(stored + 2) != item.size ||
        !known_version(item.type, item.version)) {
      fail_at_byte(source, at + kFixed + kItem * i, "an item of the compressed points that does not go with the point format");
    }
    if (layered) codec.layers += layers_of(item);
  }
  return codec;
}

}  // namespace g3r::io
