// What the lines of a text with one point per line look like, before their numbers are read: how many points and columns there are, what
// separates these, what names them.
#pragma once

#include "io/column_names.h"
#include "io/text.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace g3r::io {

/// What a look at the lines alone tells.
struct TextShape {
  char separator = ' ';
  std::size_t columns = 0;
  std::uint64_t points = 0;
  bool counted = false;                    ///< PTS
  std::optional<std::uint64_t> announced;  ///< PointLines::announced()
  ColumnNames header;                      ///< no names: the text has none
  int unused_headers = 0;                  ///< lines of words before the points that do not name the columns
  std::size_t unused_line = 0;             ///< the first of these
  std::string unused_text;                 ///< its beginning
  bool open_end = false;                   ///< the last line has no line end
  bool open_rows = false;                  ///< every line ends with a separator

  /// Whether the columns are x, y and z and need no more than that.
  [[nodiscard]] bool is_bare() const { return columns <= 3 && header.names.empty(); }
};

/// "column 3 "z"", or "column 3" where it has no name. Columns count from 0, texts from 1.
std::string column_text(const TextShape& shape, std::size_t column);

/// Reads the text once, and its first lines again. Tabs that leave lines with different columns are blanks, if blanks do not. Throws
/// InvalidInput for fewer than three columns or more than 1000, and for points that are fewer than a count line says. A text without points
/// is none of these: `points` is 0.
TextShape measure(const Text& text);

}  // namespace g3r::io
