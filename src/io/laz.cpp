// A LAZ file as the LAS file that it stands for: its header without the mark of LAZ, its chunks decoded (laz_chunks.h).
#include "io/laz.h"

#include "io/copc.h"
#include "io/laz_chunks.h"
#include "io/subset.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>

namespace g3r::io {

namespace {

using namespace las;

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
std::vector<LazChunk> chunks_of(const Source& source, const std::vector<LazChunk>& chunks, const std::vector<CopcCell>& cells) {
  std::vector<LazChunk> chosen;
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
  const LazCodec codec = read_laz_codec(source, header);
  if (header.count == 0) {
    constexpr std::size_t kEmptyTable = 16;  // its place, version and number of chunks
    const std::size_t rest = find_rest(source, header, source.bytes.size(), header.points_at);
    if (rest - header.points_at >= kEmptyTable + header.record_bytes)
      fail_at_byte(source, kLegacyCount, "the header has no points (count 0), but compressed points follow it");
    return plain_header(source, header, source.bytes.size(), rest).append(source.bytes.substr(rest));
  }
  FileBytes file(source);
  check_laz_ratio(file, header);
  const std::size_t table = find_laz_table(file, header);
  try {
    std::vector<LazChunk> chunks = read_laz_table(file, header, codec, table);
    for (const LazChunk& chunk : chunks) check_laz_chunk(source, header, codec, chunk, file.get(chunk.begin, chunk.bytes));
    LasHeader part = header;
    const bool parted = (options.box || options.levels != 0) && is_copc(source, header);
    if (parted) {
      chunks = chunks_of(source, chunks, find_copc_cells(source, header, options));
      part.count = 0;
      for (const LazChunk& chunk : chunks) part.count += chunk.points;
    }
    const std::size_t rest = find_rest(source, header, file.size(), table);
    std::string las = plain_header(source, part, file.size(), rest);
    for (const LazChunk& chunk : chunks)
      LazDecoder(header, codec, chunk, file.get(chunk.begin, chunk.bytes)).read(chunk.points, source, las);
    if (parted) fit_las_header(las, part.count);
    las += source.bytes.substr(rest);
    return las;
  } catch (int) {  // what LASzip throws
    fail_at_byte(source, table, "truncated or damaged: LASzip cannot decode the compressed points");
  }
}

struct LazRecords::State {
  State(const Source& head, const LasHeader& of, const RandomFile& from)
      : name(head.name), source{{}, name}, header(of), codec(read_laz_codec(head, of)), file(source, from) {}

  std::string name;
  Source source;  // for messages
  LasHeader header;
  LazCodec codec;
  FileBytes file;
  std::vector<LazChunk> chunks;
  std::size_t rest = 0;  // place of what follows the points
  std::string las_head;
  std::size_t chunk = 0;  // the next to be decoded
  std::optional<LazDecoder> decoder;
};

LazRecords::LazRecords(const Source& head, const LasHeader& header, const RandomFile& file)
    : state_(std::make_unique<State>(head, header, file)) {
  check_laz_ratio(state_->file, header);
  const std::size_t table = find_laz_table(state_->file, header);
  try {
    state_->chunks = read_laz_table(state_->file, header, state_->codec, table);
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
        const LazChunk& chunk = s.chunks[s.chunk++];
        const std::string_view bytes = s.file.get(chunk.begin, chunk.bytes);
        check_laz_chunk(s.source, s.header, s.codec, chunk, bytes);
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
