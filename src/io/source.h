// The bytes of an input, and the errors that point into them.
#pragma once

#include <g3r/io.h>

#include <string>
#include <string_view>

namespace g3r::io {

/// An input in memory. `name` is the path as the user gave it.
struct Source {
  std::string_view bytes;
  std::string name;
};

/// Reads a whole file, or standard input for "-", in blocks. Of a stream no more is read than is needed to see that it is no known format.
/// Throws IoError.
std::string read_bytes(const std::string& path);

/// Text from the file in quotes: clipped to 40 bytes, control characters escaped.
std::string quote(std::string_view text);

/// Throw InvalidInput: file, place, and `what`: expected, found, hint.
[[noreturn]] void fail(const Source& source, const std::string& what);
[[noreturn]] void fail_without_faces(const Source& source, const std::string& what);  // NoFaces
[[noreturn]] void fail_at_byte(const Source& source, std::size_t offset, const std::string& what);
[[noreturn]] void fail_at_line(const Source& source, std::size_t line, const std::string& what);

/// The extension of a path in lower case, without the dot; "" if there is none.
std::string extension(const std::string& path);

}  // namespace g3r::io
