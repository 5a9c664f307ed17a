// The header of a PCD file. Source: pointclouds.org, "The PCD (Point Cloud Data) file format".
#pragma once

#include "io/source.h"
#include "io/table.h"

#include <cstddef>
#include <string>
#include <vector>

namespace g3r::io {

struct PcdHeader {
  Element points = make_vertex_element();  ///< without data
  std::string encoding;                    ///< ascii, binary, binary_compressed
  std::size_t body = 0;                    ///< byte offset of the points
  std::size_t lines = 0;                   ///< lines of the header
  std::vector<std::string> kept;           ///< VIEWPOINT, WIDTH, HEIGHT lines
  std::vector<Vec3> viewpoint;             ///< position of the sensor, if it is known
};

/// Reads and checks a header. Throws InvalidInput.
PcdHeader read_pcd_header(const Source& source);

}  // namespace g3r::io
