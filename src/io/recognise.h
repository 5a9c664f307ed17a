// Which format a file has, recognised by its content alone.
#pragma once

#include "io/source.h"

#include <cstdint>

namespace g3r::io {

enum class Format { kPly, kPcd, kNpy, kLas, kE57, kOff, kObj, kStlBinary, kStlText, kGlb, kGltf, kPtx, kAsciiGrid, kSpz, kText };

/// The format of the file that starts with these bytes. A UTF-8 byte order mark is skipped.
/// Throws InvalidInput for an empty file and for everything that no reader takes, naming what it is where that can be told.
Format recognise(const Source& source);

/// The bytes without a UTF-8 byte order mark.
std::string_view without_mark(std::string_view bytes);

/// Whether a file that begins with these bytes has exactly the size that a binary STL file with their triangle count has (the format has
/// no magic).
bool is_binary_stl(std::string_view bytes, std::uint64_t file_size);

}  // namespace g3r::io
