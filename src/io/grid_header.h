// The header of an Arc/Info (Esri) ASCII grid, the text of terrain models: lines of a key and a number, in any order and any case, and then
// the values row by row from the north, however they are broken into lines. Keys: ncols, nrows, xllcorner or xllcenter, yllcorner or
// yllcenter, cellsize or dx and dy, NODATA_value.
#pragma once

#include "io/text.h"

#include <g3r/points.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace g3r::io {

/// What stands for no value where no NODATA_value says so.
inline constexpr double kUsualNoData = -9999;

struct GridHeader {
  std::uint64_t columns = 0;
  std::uint64_t rows = 0;             ///< with the columns no more values than the file has room for
  std::array<double, 2> corner{};     ///< x and y of the south-western cell: of its corner, or of its middle
  std::array<double, 2> to_middle{};  ///< from there to its middle, in cells
  std::array<double, 2> size{};       ///< of a cell, above 0
  double no_data = kUsualNoData;      ///< what stands for no value; may be nan or infinite
  std::uint64_t offset = 0;           ///< of the first line of values,
  std::size_t lines = 0;              ///< and how many lines come before it

  /// "50 x 40 values (ncols x nrows)", for messages.
  [[nodiscard]] std::string counts() const;
};

/// Throws InvalidInput.
GridHeader read_grid_header(const Text& text);

/// Whether a text begins like such a grid: two lines of its first keys, or more, before the first number.
bool is_ascii_grid(std::string_view bytes);

}  // namespace g3r::io
