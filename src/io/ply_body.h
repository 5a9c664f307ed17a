// The records of a PLY file: text, or binary in either byte order.
#pragma once

#include "io/ply_header.h"

#include <string>
#include <vector>

namespace g3r::io {

/// Reads the data of the header's elements, in their order. Every element is kept record by record; nothing is allocated that the body does
/// not fill. Throws InvalidInput.
void read_ply_body(const Source& source, PlyHeader& header, std::vector<std::string>& warnings);

}  // namespace g3r::io
