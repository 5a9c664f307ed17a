// LAZ, which is LAS with compressed points. Only laz.cpp and pack_laz.cpp know LASzip; laz_not_compiled.cpp stands in for both.
#pragma once

#include "io/las.h"

#include <string>

namespace g3r::io {

/// Whether LAZ files can be read and written.
bool laz_is_compiled();

/// Throws InvalidInput, with the name of a converter, if LAZ files cannot be read.
void require_laz(const Source& source);

/// The LAS file that a LAZ file stands for: the same header, variable length records and records of points, byte for byte, and what follows
/// the points. `header` is that of `source`. Of COPC, whose own record is left out, only the cells that `options` ask for; counts and
/// bounds are theirs. Throws InvalidInput, also if that would be more than 256 times the size of the file.
std::string unpack_laz(const Source& source, const LasHeader& header, const ReadOptions& options = {});

}  // namespace g3r::io
