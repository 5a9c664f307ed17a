// How the points of a LAZ file are compressed, as its record "laszip encoded" says. Only sources that have LASzip's headers include this.
#pragma once

#include "io/las.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <laszip.hpp>

namespace g3r::io {

/// How points are compressed: in items, one after the other in the record.
struct LazCodec {
  unsigned compressor = 0;
  std::uint32_t chunk_points = 0;
  std::vector<LASitem> items;
  std::size_t layers = 0;  ///< streams in a chunk of point formats 6 to 10, 0 otherwise
};

/// Reads the record and holds it against the point format. Throws InvalidInput.
LazCodec read_laz_codec(const Source& source, const LasHeader& header);

}  // namespace g3r::io
