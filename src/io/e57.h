// E57 (ASTM E2807): scans in binary sections, each with its own pose, described by XML. Only e57.cpp and e57_scans.cpp know libE57Format;
// in builds without it (e57_not_compiled.cpp) read_e57() and stream_e57() throw. What follows checks what the library would trust.
#pragma once

#include "io/file_bytes.h"

#include <cstdint>
#include <string>
#include <vector>

namespace g3r::io {

/// Checks the pages of an E57 file (sizes, checksums, version) and its XML: UTF-8, no document type, no schemas to be loaded, few and
/// shallow elements, compressed vectors complete. Throws InvalidInput.
void check_e57(FileBytes& file);

/// Checks the packets of a checked file's binary section that starts at a logical offset. Returns the bytes of each of its `streams`
/// streams. Throws InvalidInput.
std::vector<std::uint64_t> check_e57_packets(FileBytes& file, std::uint64_t section, std::size_t streams);

}  // namespace g3r::io
