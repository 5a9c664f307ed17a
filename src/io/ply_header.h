// The header of a PLY file. Source: Greg Turk, "The PLY Polygon File Format", 1994.
#pragma once

#include "io/source.h"
#include "io/table.h"

#include <cstddef>
#include <string>
#include <vector>

namespace g3r::io {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<std::string> comments;  ///< whole lines, "comment ..." or "obj_info ..."
  std::vector<Element> elements;      ///< without data
  std::size_t vertex = 0;             ///< index of the element "vertex"
  std::size_t body = 0;               ///< byte offset of the first record
  std::size_t lines = 0;              ///< lines of the header
};

/// Reads and checks a header. Throws InvalidInput.
PlyHeader read_ply_header(const Source& source);

}  // namespace g3r::io
