// The header of an NPY file. It is parsed, never evaluated, and object arrays are refused. Source: numpy.lib.format.
#pragma once

#include "io/source.h"
#include "io/table.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::io {

struct NpyHeader {
  std::vector<Property> fields;  ///< one without a name for a plain array; of structured ones such are padding
  bool big_endian = false;
  bool half = false;  ///< float16
  bool column_major = false;
  std::vector<std::uint64_t> shape;
  std::size_t body = 0;  ///< byte offset of the first value

  [[nodiscard]] bool is_structured() const { return !fields[0].name.empty() || fields.size() > 1; }
  /// Whether padding lies between or after the fields of a structured array.
  [[nodiscard]] bool is_padded() const;
  [[nodiscard]] bool is_in_rows() const { return !column_major || is_structured(); }
};

/// Reads a header. Throws InvalidInput.
NpyHeader read_npy_header(const Source& source);

}  // namespace g3r::io
