// LAZ out: LASzip packs one chunk of points at a time into memory; header, chunks and the table of their sizes are put together here.
#include "io/las.h"
#include "io/las_output.h"
#include "io/laz.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <arithmeticencoder.hpp>
#include <bytestreamout_array.hpp>
#include <integercompressor.hpp>
#include <laswritepoint.hpp>
#include <laszip.hpp>

namespace g3r::io {

namespace {

using namespace las;

constexpr std::uint32_t kChunkPoints = 50000;  // LASzip's own choice: readers that skip chunks expect about as many

void require(bool done) {
  if (!done) throw Error("write_cloud: LASzip cannot pack the points");
}

std::string bytes_of(const ByteStreamOutArray& stream) {
  return {reinterpret_cast<const char*>(stream.getData()), static_cast<std::size_t>(stream.getSize())};
}

// The layout in which LASzip takes the first item of point formats 6 to 10: fields of old formats and new ones side by side.
std::array<unsigned char, 128> point14(const char* record) {
  std::array<unsigned char, 128> item{};
  const auto* from = reinterpret_cast<const unsigned char*>(record);
  std::copy_n(from, 14, item.begin());  // x y z, intensity
  item[14] = from[15] & 0xC0;           // scan direction, edge of flight line
  item[15] = static_cast<unsigned char>((from[16] < 32 ? from[16] : 0) | from[15] << 5);
  item[17] = from[17];                                                                  // user data
  std::copy_n(from + 20, 2, item.begin() + 18);                                         // point source
  std::copy_n(from + 18, 2, item.begin() + 20);                                         // scan angle
  item[22] = static_cast<unsigned char>(1 | (from[15] >> 4 & 3) << 2 | from[15] << 4);  // channel, flags
  item[23] = from[16];                                                                  // classification
  item[24] = from[14];                                                                  // returns
  std::copy_n(from + 22, 8, item.begin() + 32);                                         // time
  return item;
}

class PackedLas : public LasOutput {
 public:
  explicit PackedLas(OutputFile& file) : file_(file) {}

  void header(const std::string& text) override {
    const auto format = static_cast<unsigned char>(text[kPointFormat]);
    layered_ = format >= 6;
    require(how_.setup(format, load<std::uint16_t>(text.data() + kRecordBytes),
                       layered_ ? LASZIP_COMPRESSOR_LAYERED_CHUNKED : LASZIP_COMPRESSOR_CHUNKED) != 0);
    how_.set_chunk_size(kChunkPoints);
    how_.request_version(layered_ ? 3 : 2);
    las_points_at_ = text.size();
    header_ = text + description();
    header_[kPointFormat] = static_cast<char>(header_[kPointFormat] | 0x80);
    put(header_, kVlrCount, load<std::uint32_t>(header_.data() + kVlrCount) + 1);
    put(header_, kPointsAt, static_cast<std::uint32_t>(header_.size()));
    header_.append(sizeof(std::uint64_t), '\0');  // where the table of chunks will be
    if (file_.can_overwrite()) file_.write(header_);
  }

  void record(const std::string& bytes) override {
    if (!writer_) begin_chunk();
    const auto* record = reinterpret_cast<const U8*>(bytes.data());
    const std::array<unsigned char, 128> first = layered_ ? point14(bytes.data()) : std::array<unsigned char, 128>{};
    items_.clear();
    for (unsigned k = 0; k < how_.num_items; record += how_.items[k++].size) items_.push_back(record);
    if (layered_) items_[0] = first.data();
    require(writer_->write(items_.data()) != 0);
    if (++in_chunk_ == kChunkPoints) end_chunk();
  }

  void finish(std::uint64_t rest) override {
    if (writer_) end_chunk();
    const std::string table = chunk_table();
    const std::uint64_t table_at = header_.size() + packed_bytes_;
    const std::uint64_t las_rest = las_points_at_ + points_ * load<std::uint16_t>(header_.data() + kRecordBytes);
    const std::uint64_t moved = table_at + table.size() - las_rest;  // modulo 2^64
    const auto shift = [&](std::size_t field) {
      const auto at = load<std::uint64_t>(header_.data() + field);
      if (at >= las_rest && rest != 0) put(header_, field, at + moved);
    };
    const auto minor = static_cast<unsigned char>(header_[kMinor]);
    if (minor >= 3 && load<std::uint16_t>(header_.data() + kHeaderSize) >= kWaveform + 8) shift(kWaveform);
    if (minor == 4) shift(kEvlrAt);
    put(header_, header_.size() - sizeof table_at, table_at);
    if (file_.can_overwrite()) {
      file_.overwrite(0, header_);
    } else {
      file_.write(header_);
      file_.write(packed_);
    }
    file_.write(table);
  }

  void rest(std::string_view bytes) override { file_.write(bytes); }

 private:
  void begin_chunk() {
    stream_ = std::make_unique<ByteStreamOutArrayLE>();
    writer_ = std::make_unique<LASwritePoint>();
    require(writer_->setup(how_.num_items, how_.items, &how_) != 0 && writer_->init(stream_.get()) != 0);
    in_chunk_ = 0;
  }

  // LASzip puts the place of its table before the chunk, and after it the table, which is not that of the file.
  void end_chunk() {
    require(writer_->done() != 0);
    const std::string bytes = bytes_of(*stream_);
    const auto end = static_cast<std::size_t>(load<std::uint64_t>(bytes.data()));
    chunks_.push_back(static_cast<std::uint32_t>(end - sizeof(std::uint64_t)));
    const std::string_view chunk = std::string_view(bytes).substr(sizeof(std::uint64_t), chunks_.back());
    packed_bytes_ += chunk.size();
    if (file_.can_overwrite()) {
      file_.write(chunk);
    } else {
      packed_ += chunk;
    }
    points_ += in_chunk_;
    writer_.reset();
    stream_.reset();
  }

  // The record "laszip encoded".
  std::string description() {
    U8* bytes = nullptr;  // LASzip's
    I32 size = 0;
    require(how_.pack(bytes, size) != 0);
    std::string vlr(kVlrHeader, '\0');
    vlr.replace(2, 14, "laszip encoded");
    put(vlr, 18, static_cast<std::uint16_t>(kCompression));
    put(vlr, 20, static_cast<std::uint16_t>(size));
    vlr.replace(22, 14, "by LASzip, g3r");
    return vlr.append(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  }

  // A version, the number of chunks, then the packed differences of their sizes.
  std::string chunk_table() const {
    ByteStreamOutArrayLE stream;
    const U32 version = 0;
    const auto number = static_cast<U32>(chunks_.size());
    require(stream.put32bitsLE(reinterpret_cast<const U8*>(&version)) != 0 &&
            stream.put32bitsLE(reinterpret_cast<const U8*>(&number)) != 0);
    if (!chunks_.empty()) {
      ArithmeticEncoder encoder;
      encoder.init(&stream);
      IntegerCompressor differences(&encoder, 32, 2);
      differences.initCompressor();
      U32 before = 0;
      for (const U32 bytes : chunks_) {
        differences.compress(static_cast<I32>(before), static_cast<I32>(bytes), 1);
        before = bytes;
      }
      encoder.done();
    }
    return bytes_of(stream);
  }

  OutputFile& file_;
  std::string header_;  // of the LAZ file, and the place of the table of chunks
  std::size_t las_points_at_ = 0;
  LASzip how_;
  bool layered_ = false;
  std::unique_ptr<ByteStreamOutArrayLE> stream_;
  std::unique_ptr<LASwritePoint> writer_;
  std::vector<const U8*> items_;
  std::uint32_t in_chunk_ = 0;
  std::uint64_t points_ = 0;
  std::uint64_t packed_bytes_ = 0;
  std::string packed_;  // chunks that wait for the header
  std::vector<std::uint32_t> chunks_;
};

}  // namespace

std::unique_ptr<LasOutput> packed_las(OutputFile& file) { return std::make_unique<PackedLas>(file); }

}  // namespace g3r::io
