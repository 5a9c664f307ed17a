// LAZ files hold chunks of points, each compressed on its own, and a table of their sizes: found, checked, decoded. LASzip trusts the sizes
// that a file states, so all of them are checked before it sees them.
// Source: M. Isenburg, "LASzip: lossless compression of LiDAR data", Photogrammetric Engineering & Remote Sensing 79(2), 2013, and LASzip.
#pragma once

#include "io/file_bytes.h"
#include "io/laz_codec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <bytestreamin_array.hpp>
#include <lasreadpoint.hpp>
#include <laszip.hpp>

namespace g3r::io {

/// Points that are compressed on their own.
struct LazChunk {
  std::size_t begin;  ///< byte offset in the file
  std::size_t bytes;
  std::uint32_t points;
};

/// Counts that no honest file has, before memory is taken for them. Throws InvalidInput.
void check_laz_ratio(const FileBytes& file, const LasHeader& header);

/// Where the table of chunks begins. Throws InvalidInput, IoError.
std::size_t find_laz_table(FileBytes& file, const LasHeader& header);

/// The chunks in the table that begins at byte `table`, all within the file and with all its points. Throws InvalidInput, IoError, and int
/// where LASzip cannot decode it.
std::vector<LazChunk> read_laz_table(FileBytes& file, const LasHeader& header, const LazCodec& codec, std::size_t table);

/// Checks what follows the first record of a chunk of these bytes: the beginning of its stream, or the number of points and the sizes of
/// the layers. Throws InvalidInput.
void check_laz_chunk(const Source& source, const LasHeader& header, const LazCodec& codec, const LazChunk& chunk, std::string_view bytes);

/// Decodes a checked chunk of these bytes, some records at a time: LASzip sees bytes that are this chunk and nothing else.
class LazDecoder {
 public:
  LazDecoder(const LasHeader& header, const LazCodec& codec, const LazChunk& chunk, std::string_view bytes);
  [[nodiscard]] std::uint32_t left() const { return chunk_.points - done_; }
  /// Appends the next records, at most `most`. Throws InvalidInput.
  void read(std::size_t most, const Source& source, std::string& records);

 private:
  static constexpr std::size_t kItem14 = 128;  // at least the size of LASzip's LASpoint14, 56 bytes in 3.5

  LazChunk chunk_;
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

}  // namespace g3r::io
