#include "io/laz_chunks.h"

#include <algorithm>
#include <string>

#include <arithmeticdecoder.hpp>
#include <integercompressor.hpp>

namespace g3r::io {

using namespace las;

namespace {

// What unpacks to more than this many times the size of its file is refused. Lidar packs to a tenth or so, equal points to a
// two-thousandth. Larger: more memory for hostile files; smaller: regular grids are refused.
constexpr std::uint64_t kMostRatio = 256;
constexpr std::uint32_t kAnyChunks = 0xFFFFFFFF;  // as the size of chunks: the table gives that of each
constexpr std::size_t kTableFixed = 1024;         // bytes that the compressed table of chunks takes at most,
constexpr std::size_t kTableEntry = 16;           // and for each of them: two numbers, each in less than six

// A decoder that starts at a number not below its range leaves its tables; no encoder makes that.
void check_start(const Source& source, std::size_t at, std::string_view bytes) {
  if (bytes.size() < 4 || load<std::uint32_t>(bytes.data()) == 0xFFFFFFFF)
    fail_at_byte(source, at, "truncated or damaged: no compressed data where they should begin");
}

// LASzip keeps the first item of point formats 6 to 10 in a layout of its own, in which old and new fields lie side by side.
void store_point14(const unsigned char* from, unsigned char* record) {
  std::copy_n(from, 14, record);  // x y z, intensity
  record[14] = from[24];
  record[15] = static_cast<unsigned char>((from[22] >> 4) | ((from[22] >> 2 & 3) << 4) | (from[14] & 0xC0));
  record[16] = from[23];
  record[17] = from[17];
  std::copy_n(from + 20, 2, record + 18);  // scan angle
  std::copy_n(from + 18, 2, record + 20);  // point source
  std::copy_n(from + 32, 8, record + 22);  // time
}

}  // namespace

void check_laz_ratio(const FileBytes& file, const LasHeader& header) {
  if (header.count > kMostRatio * file.size() / header.record_bytes) {
    fail_at_byte(
        file.source(), kLegacyCount,
        std::to_string(header.count) + " points of " + std::to_string(header.record_bytes) + " bytes in a file of " +
            std::to_string(file.size()) +
            " bytes, more than 256 times its size: the count is damaged, or the points are all alike; then convert the file to LAS");
  }
}

std::size_t find_laz_table(FileBytes& file, const LasHeader& header) {
  const Source& source = file.source();
  const std::size_t size = file.size();
  if (size - header.points_at < 16) fail_at_byte(source, size, "truncated: the compressed points are missing");
  auto at = load<std::int64_t>(file.get(header.points_at, 8).data());
  if (at == -1) at = load<std::int64_t>(file.get(size - 8, 8).data());  // written to a pipe
  if (at < static_cast<std::int64_t>(header.points_at) + 8 || at > static_cast<std::int64_t>(size) - 8) {
    fail_at_byte(source, header.points_at,
                 "truncated: the table of the compressed chunks should be at byte " + std::to_string(at) + " of a file of " +
                     std::to_string(size) + " bytes");
  }
  return static_cast<std::size_t>(at);
}

// As LASzip stores it: a version, the number of chunks, then compressed differences of their points and bytes.
std::vector<LazChunk> read_laz_table(FileBytes& file, const LasHeader& header, const LazCodec& codec, std::size_t table) {
  const Source& source = file.source();
  const bool any = codec.chunk_points == kAnyChunks;
  const std::string_view head = file.get(table, 8);
  const auto version = load<std::uint32_t>(head.data());
  const auto number = load<std::uint32_t>(head.data() + 4);
  const std::uint64_t wanted = any ? number : (header.count + codec.chunk_points - 1) / codec.chunk_points;
  if (version != 0 || number != wanted || number == 0 ||
      number > (table - header.points_at - 8) / header.record_bytes) {  // a chunk begins with a whole record
    fail_at_byte(source, table,
                 "damaged: the table of compressed chunks has " + std::to_string(number) + " entries, which does not go with " +
                     std::to_string(header.count) + " points");
  }
  const std::size_t most = kTableFixed + kTableEntry * std::size_t{number};
  const std::string_view bytes = file.get(table + 8, std::min(file.size() - table - 8, most));
  check_start(source, table + 8, bytes);
  ByteStreamInArrayLE stream(reinterpret_cast<const U8*>(bytes.data()), static_cast<I64>(bytes.size()));
  ArithmeticDecoder decoder;
  decoder.init(&stream);
  IntegerCompressor differences(&decoder, 32, 2);
  differences.initDecompressor();
  std::vector<LazChunk> chunks;
  chunks.reserve(number);
  std::size_t begin = header.points_at + 8;
  std::uint64_t left = header.count;
  I32 points = 0;
  I32 size = 0;
  for (std::uint32_t i = 0; i < number; ++i) {
    points = any ? differences.decompress(points, 0) : static_cast<I32>(std::min<std::uint64_t>(left, codec.chunk_points));
    size = differences.decompress(size, 1);
    const LazChunk chunk{begin, static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(points)};
    if (chunk.bytes < header.record_bytes || chunk.bytes > table - begin || chunk.points == 0 || chunk.points > left)
      fail_at_byte(source, table, "damaged: chunk " + std::to_string(i + 1) + " of the table of compressed chunks does not fit");
    chunks.push_back(chunk);
    begin += chunk.bytes;
    left -= chunk.points;
  }
  if (left != 0) fail_at_byte(source, table, "damaged: the compressed chunks hold " + std::to_string(header.count - left) + " points");
  return chunks;
}

void check_laz_chunk(const Source& source, const LasHeader& header, const LazCodec& codec, const LazChunk& chunk, std::string_view bytes) {
  std::size_t at = header.record_bytes;
  const auto place = [&] { return chunk.begin + at; };
  if (codec.layers == 0) {
    check_start(source, place(), bytes.substr(at));
    return;
  }
  if (bytes.size() - at < 4 + 4 * codec.layers)
    fail_at_byte(source, place(), "damaged: a compressed chunk ends within the sizes of its layers");
  const char* sizes = bytes.data() + at + 4;
  if (load<std::uint32_t>(sizes - 4) != chunk.points)
    fail_at_byte(source, place(), "damaged: a compressed chunk has another number of points");
  at += 4 + 4 * codec.layers;
  for (std::size_t i = 0; i < codec.layers; ++i) {
    const auto size = load<std::uint32_t>(sizes + 4 * i);
    if (size > bytes.size() - at) fail_at_byte(source, place(), "damaged: the layers of a compressed chunk do not fit in it");
    if (size != 0 || i == 0) check_start(source, place(), bytes.substr(at, size));
    at += size;
  }
  if (at != bytes.size()) fail_at_byte(source, place(), "damaged: a compressed chunk is longer than its layers");
}

LazDecoder::LazDecoder(const LasHeader& header, const LazCodec& codec, const LazChunk& chunk, std::string_view bytes)
    // With a table "at" the points themselves LASzip reads the chunk without one.
    : chunk_(chunk), layered_(codec.layers != 0), bytes_(std::string(8, '\0').append(bytes)), record_(header.record_bytes) {
  how_.compressor = static_cast<unsigned short>(codec.compressor);
  how_.chunk_size = chunk.points;
  how_.num_items = static_cast<unsigned short>(codec.items.size());
  how_.items = new LASitem[codec.items.size()];  // belongs to LASzip
  std::copy(codec.items.begin(), codec.items.end(), how_.items);
  stream_ = std::make_unique<ByteStreamInArrayLE>(reinterpret_cast<const U8*>(bytes_.data()), static_cast<I64>(bytes_.size()));
  ok_ = reader_.setup(how_.num_items, how_.items, &how_) != 0 && reader_.init(stream_.get()) != 0;
  for (std::size_t k = 0, offset = 0; k < codec.items.size(); offset += codec.items[k++].size) items_.push_back(record_.data() + offset);
  if (layered_) items_[0] = point14_.data();
}

void LazDecoder::read(std::size_t most, const Source& source, std::string& records) {
  for (std::size_t i = 0; ok_ && i < most && done_ < chunk_.points; ++i, ++done_) {
    ok_ = reader_.read(items_.data()) != 0;
    if (layered_) store_point14(point14_.data(), record_.data());
    records.append(reinterpret_cast<const char*>(record_.data()), record_.size());
  }
  if (!ok_ || (left() == 0 && stream_->tell() != static_cast<I64>(bytes_.size())))
    fail_at_byte(source, chunk_.begin, "damaged: LASzip cannot decode the chunk of compressed points that begins here");
}

}  // namespace g3r::io
