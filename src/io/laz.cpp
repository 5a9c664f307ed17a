// LAZ files hold chunks of points, each compressed on its own, and a table of their sizes. LASzip decodes one chunk at a time, from bytes
// that are this chunk and nothing else. It trusts the sizes that a file states, so all of them are checked here before it sees them.
// Source: M. Isenburg, "LASzip: lossless compression of LiDAR data", Photogrammetric Engineering & Remote Sensing 79(2), 2013, and LASzip.
#include "io/laz.h"

#include "io/copc.h"
#include "io/file_bytes.h"
#include "io/subset.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include <arithmeticdecoder.hpp>
#include <bytestreamin_array.hpp>
#include <integercompressor.hpp>
#include <lasreadpoint.hpp>
#include <laszip.hpp>

namespace g3r::io {

namespace {

using namespace las;

// What unpacks to more than this many times the size of its file is refused. Lidar packs to a tenth or so, equal points to a
// two-thousandth. Larger: more memory for hostile files; smaller: regular grids are refused.
constexpr std::uint64_t kMostRatio = 256;
constexpr std::uint32_t kAnyChunks = 0xFFFFFFFF;  // as the size of chunks: the table gives that of each
constexpr std::size_t kTableFixed = 1024;         // bytes that the compressed table of chunks takes at most,
constexpr std::size_t kTableEntry = 16;           // and for each of them: two numbers, each in less than six
constexpr std::size_t kPoint14 = 30;              // bytes of a record of format 6 or later before its other items
constexpr std::size_t kPoint14Layers = 9;
constexpr std::size_t kItem14 = 128;  // at least the size of LASzip's LASpoint14, 56 bytes in 3.5

// How points are compressed: in items, one after the other in the record.
struct Codec {
  unsigned compressor = 0;
  std::uint32_t chunk_points = 0;
  std::vector<LASitem> items;
  std::size_t layers = 0;  // streams in a chunk of point formats 6 to 10, 0 otherwise
};

struct Chunk {
  std::size_t begin;  // byte offset in the file
  std::size_t bytes;
  std::uint32_t points;
};

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

// The record "laszip encoded": compressor, coder (u16), version (u8, u8, u16), options, size of chunks (u32), two u64 that are not used,
// the number of items (u16), and type, size, version (u16) of each.
Codec read_codec(const Source& source, const LasHeader& header) {
  constexpr std::size_t kFixed = 34;
  constexpr std::size_t kItem = 6;
  if (header.laszip_vlr == 0)
    fail_at_byte(source, kVlrCount, "a LAZ file without the record \"laszip encoded\", which says how it is compressed");
  const std::size_t at = header.laszip_vlr + kVlrHeader;
  const char* bytes = source.bytes.data() + at;
  const auto length = load<std::uint16_t>(source.bytes.data() + header.laszip_vlr + 20);
  Codec codec;
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

// A decoder that starts at a number not below its range leaves its tables; no encoder makes that.
void check_start(const Source& source, std::size_t at, std::string_view bytes) {
  if (bytes.size() < 4 || load<std::uint32_t>(bytes.data()) == 0xFFFFFFFF)
    fail_at_byte(source, at, "truncated or damaged: no compressed data where they should begin");
}

// Counts that no honest file has, before memory is taken for them.
void check_ratio(const FileBytes& file, const LasHeader& header) {
  if (header.count > kMostRatio * file.size() / header.record_bytes) {
    fail_at_byte(
        file.source(), kLegacyCount,
        std::to_string(header.count) + " points of " + std::to_string(header.record_bytes) + " bytes in a file of " +
            std::to_string(file.size()) +
            " bytes, more than 256 times its size: the count is damaged, or the points are all alike; then convert the file to LAS");
  }
}

// Where the table of chunks begins.
std::size_t find_table(FileBytes& file, const LasHeader& header) {
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

// Number of points and bytes of each chunk, as LASzip stores them: a version, their number, then compressed differences.
std::vector<Chunk> read_table(FileBytes& file, const LasHeader& header, const Codec& codec, std::size_t table) {
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
  std::vector<Chunk> chunks;
  chunks.reserve(number);
  std::size_t begin = header.points_at + 8;
  std::uint64_t left = header.count;
  I32 points = 0;
  I32 size = 0;
  for (std::uint32_t i = 0; i < number; ++i) {
    points = any ? differences.decompress(points, 0) : static_cast<I32>(std::min<std::uint64_t>(left, codec.chunk_points));
    size = differences.decompress(size, 1);
    const Chunk chunk{begin, static_cast<std::uint32_t>(size), static_cast<std::uint32_t>(points)};
    if (chunk.bytes < header.record_bytes || chunk.bytes > table - begin || chunk.points == 0 || chunk.points > left)
      fail_at_byte(source, table, "damaged: chunk " + std::to_string(i + 1) + " of the table of compressed chunks does not fit");
    chunks.push_back(chunk);
    begin += chunk.bytes;
    left -= chunk.points;
  }
  if (left != 0) fail_at_byte(source, table, "damaged: the compressed chunks hold " + std::to_string(header.count - left) + " points");
  return chunks;
}

// What follows the first record of a chunk of these bytes: the beginning of its stream, or the number of points and the sizes of the
// layers.
void check_chunk(const Source& source, const LasHeader& header, const Codec& codec, const Chunk& chunk, std::string_view bytes) {
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

// Decodes a checked chunk of these bytes, some records at a time.
class ChunkDecoder {
 public:
  ChunkDecoder(const LasHeader& header, const Codec& codec, const Chunk& chunk, std::string_view bytes)
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

  [[nodiscard]] std::uint32_t left() const { return chunk_.points - done_; }

  // Appends the next records, at most `most`.
  void read(std::size_t most, const Source& source, std::string& records) {
    for (std::size_t i = 0; ok_ && i < most && done_ < chunk_.points; ++i, ++done_) {
      ok_ = reader_.read(items_.data()) != 0;
      if (layered_) store_point14(point14_.data(), record_.data());
      records.append(reinterpret_cast<const char*>(record_.data()), record_.size());
    }
    if (!ok_ || (left() == 0 && stream_->tell() != static_cast<I64>(bytes_.size())))
      fail_at_byte(source, chunk_.begin, "damaged: LASzip cannot decode the chunk of compressed points that begins here");
  }

 private:
  Chunk chunk_;
  bool layered_;
  std::string bytes_;
  LASzip how_;
  std::unique_ptr<ByteStreamInArrayLE> stream_;
  LASreadPoint reader_;
  // One point for all: LASzip leaves alone what does not change.
  alignas(8) std::array<unsigned char, kItem14> point14_{};
  std::vector<unsigned char> record_;
  std::vector<U8*> items_;
  std::uint32_t done_ = 0;
  bool ok_ = false;
};

// Where what follows the points begins in the LAZ file: waveforms or extended records, if the header gives a place after the table.
std::size_t find_rest(const Source& source, const LasHeader& header, std::size_t file_size, std::size_t table) {
  std::size_t rest = file_size;
  const auto consider = [&](std::size_t field) {
    const auto at = load<std::uint64_t>(source.bytes.data() + field);
    if (at > table && at < rest) rest = static_cast<std::size_t>(at);
  };
  if (header.minor >= 3 && header.header_size >= kWaveform + 8) consider(kWaveform);
  if (header.minor == 4 && load<std::uint32_t>(source.bytes.data() + kEvlrCount) != 0) consider(kEvlrAt);
  return rest;
}

// Header and variable length records, without the mark and the record of LAZ.
std::string plain_header(const Source& source, const LasHeader& header, std::size_t file_size, std::size_t rest) {
  std::string las(source.bytes.substr(0, header.points_at));
  const std::size_t record = kVlrHeader + load<std::uint16_t>(las.data() + header.laszip_vlr + 20);
  las.erase(header.laszip_vlr, record);
  const bool copc = is_copc(source, header);  // what its record says of chunks holds no longer
  if (copc) las.erase(header.header_size, kVlrHeader + load<std::uint16_t>(las.data() + header.header_size + 20));
  las[kPointFormat] = static_cast<char>(header.point_format);
  put(las, kVlrCount, header.vlr_count - (copc ? 2 : 1));
  put(las, kPointsAt, static_cast<std::uint32_t>(las.size()));
  const std::uint64_t moved = las.size() + header.count * header.record_bytes - rest;  // modulo 2^64 where it moves back
  const auto shift = [&](std::size_t field) {
    const auto at = load<std::uint64_t>(las.data() + field);
    if (at >= rest && rest < file_size) put(las, field, at + moved);
  };
  if (header.minor >= 3 && header.header_size >= kWaveform + 8) shift(kWaveform);
  if (header.minor == 4) shift(kEvlrAt);
  return las;
}

// The chunks that are cells; each cell must be one.
std::vector<Chunk> chunks_of(const Source& source, const std::vector<Chunk>& chunks, const std::vector<CopcCell>& cells) {
  std::vector<Chunk> chosen;
  auto chunk = chunks.begin();
  for (const CopcCell& cell : cells) {
    while (chunk != chunks.end() && chunk->begin < cell.begin) ++chunk;
    if (chunk == chunks.end() || chunk->begin != cell.begin || chunk->bytes != cell.bytes || chunk->points != cell.points)
      fail_at_byte(source, source.bytes.size(), "damaged: the COPC hierarchy names a chunk that is not in the table of chunks");
    chosen.push_back(*chunk++);
  }
  return chosen;
}

}  // namespace

bool laz_is_compiled() { return true; }

void require_laz(const Source&) {}

std::string unpack_laz(const Source& source, const LasHeader& header, const ReadOptions& options) {
  const Codec codec = read_codec(source, header);
  if (header.count == 0) {
    constexpr std::size_t kEmptyTable = 16;  // its place, version and number of chunks
    const std::size_t rest = find_rest(source, header, source.bytes.size(), header.points_at);
    if (rest - header.points_at >= kEmptyTable + header.record_bytes)
      fail_at_byte(source, kLegacyCount, "the header has no points (count 0), but compressed points follow it");
    return plain_header(source, header, source.bytes.size(), rest).append(source.bytes.substr(rest));
  }
  FileBytes file(source);
  check_ratio(file, header);
  const std::size_t table = find_table(file, header);
  try {
    std::vector<Chunk> chunks = read_table(file, header, codec, table);
    for (const Chunk& chunk : chunks) check_chunk(source, header, codec, chunk, file.get(chunk.begin, chunk.bytes));
    LasHeader part = header;
    const bool parted = (options.box || options.levels != 0) && is_copc(source, header);
    if (parted) {
      chunks = chunks_of(source, chunks, find_copc_cells(source, header, options));
      part.count = 0;
      for (const Chunk& chunk : chunks) part.count += chunk.points;
    }
    const std::size_t rest = find_rest(source, header, file.size(), table);
    std::string las = plain_header(source, part, file.size(), rest);
    for (const Chunk& chunk : chunks)
      ChunkDecoder(header, codec, chunk, file.get(chunk.begin, chunk.bytes)).read(chunk.points, source, las);
    if (parted) fit_las_header(las, part.count);
    las += source.bytes.substr(rest);
    return las;
  } catch (int) {  // what LASzip throws
    fail_at_byte(source, table, "truncated or damaged: LASzip cannot decode the compressed points");
  }
}

struct LazRecords::State {
  State(const Source& head, const LasHeader& of, const RandomFile& from)
      : name(head.name), source{{}, name}, header(of), codec(read_codec(head, of)), file(source, from) {}

  std::string name;
  Source source;  // for messages
  LasHeader header;
  Codec codec;
  FileBytes file;
  std::vector<Chunk> chunks;
  std::size_t rest = 0;  // place of what follows the points
  std::string las_head;
  std::size_t chunk = 0;  // the next to be decoded
  std::optional<ChunkDecoder> decoder;
};

LazRecords::LazRecords(const Source& head, const LasHeader& header, const RandomFile& file)
    : state_(std::make_unique<State>(head, header, file)) {
  check_ratio(state_->file, header);
  const std::size_t table = find_table(state_->file, header);
  try {
    state_->chunks = read_table(state_->file, header, state_->codec, table);
  } catch (int) {  // what LASzip throws
    fail_at_byte(head, table, "truncated or damaged: LASzip cannot decode the table of compressed chunks");
  }
  state_->rest = find_rest(head, header, state_->file.size(), table);
  state_->las_head = plain_header(head, header, state_->file.size(), state_->rest);
}

LazRecords::~LazRecords() = default;

const std::string& LazRecords::las_head() const { return state_->las_head; }

std::uint64_t LazRecords::rest() const { return state_->rest; }

void LazRecords::next(std::size_t most, std::string& records) {
  State& s = *state_;
  const std::size_t end = records.size() + most * s.header.record_bytes;
  while (records.size() < end && (s.decoder || s.chunk < s.chunks.size())) {
    const std::size_t place = s.chunks[s.decoder ? s.chunk - 1 : s.chunk].begin;
    try {
      if (!s.decoder) {
        const Chunk& chunk = s.chunks[s.chunk++];
        const std::string_view bytes = s.file.get(chunk.begin, chunk.bytes);
        check_chunk(s.source, s.header, s.codec, chunk, bytes);
        s.decoder.emplace(s.header, s.codec, chunk, bytes);
      }
      s.decoder->read((end - records.size()) / s.header.record_bytes, s.source, records);
      if (s.decoder->left() == 0) s.decoder.reset();
    } catch (int) {
      fail_at_byte(s.source, place, "truncated or damaged: LASzip cannot decode the compressed points");
    }
  }
}

}  // namespace g3r::io
