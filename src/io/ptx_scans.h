// PTX, the text of Leica's and other scanners: scan by scan a header of ten lines and one line per point of the scan's grid. The header has
// columns, rows, the position of the scanner, its three axes, and a matrix that takes a row (x y z 1) of the scan to the file's
// coordinates; a point is x y z, then an intensity, a colour, or both. "0 0 0" stands for a beam that met nothing.
#pragma once

#include "io/text.h"

#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace g3r::io {

/// One scan: where its points begin, and what its header says.
struct PtxScan {
  std::uint64_t offset = 0;  ///< of its first point in the text,
  std::size_t lines = 0;     ///< and how many lines come before it
  std::uint64_t count = 0;
  std::uint64_t hits = 0;  ///< points but for beams that met nothing
  std::size_t columns = 0;
  std::array<Vec3, 3> axes{};  ///< rows of the matrix
  Vec3 origin{};               ///< its last row: where the scanner stands

  [[nodiscard]] bool has_intensity() const { return columns == 4 || columns >= 7; }
  [[nodiscard]] bool has_color() const { return columns >= 6; }
  [[nodiscard]] std::size_t first_color() const { return columns == 6 ? 3 : 4; }
};

/// The scans of a text that have points.
struct PtxScans {
  std::vector<PtxScan> scans;
  bool open_end = false;  ///< the last line has no line end
};

/// Looks at all lines: headers are checked, points counted. Throws InvalidInput.
PtxScans find_ptx_scans(const Text& text);

}  // namespace g3r::io
