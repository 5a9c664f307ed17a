// Files that people mistake for point clouds, recognised by their first bytes.
#pragma once

#include <string_view>

namespace g3r::io {

/// What a file that begins with these bytes is and what to do with it, "a zip archive (compressed); unpack it first"; null where it is none
/// of those known. SPZ is to be told first: it is a gzip file too.
const char* find_stranger(std::string_view bytes);

}  // namespace g3r::io
