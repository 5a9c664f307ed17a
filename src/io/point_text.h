// Text with one point per line, before it becomes a cloud: where its points are, and their numbers. Blanks, commas or semicolons separate
// the columns; a header line may name them; PTS files start with the number of points. What the columns are: find_columns.h.
#pragma once

#include "io/column_names.h"
#include "io/table.h"
#include "io/text.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// The lines that hold points: neither comments nor the header line, nor the count lines of a PTS file.
class PointLines {
 public:
  explicit PointLines(const Text& text) : source_(&text.source()), lines_(text.lines()) {}
  /// The next one; false at the end. Throws InvalidInput where fewer lines follow than a count line says.
  bool next(std::string_view& line);
  /// Of the line that next() gave last.
  [[nodiscard]] std::size_t number() const { return lines_.number(); }
  /// Whether there was a count line.
  [[nodiscard]] bool counted() const { return counted_; }
  /// What the first count line says that more points follow than it says.
  [[nodiscard]] std::optional<std::uint64_t> announced() const { return announced_; }
  /// Whether the last line has no line end.
  [[nodiscard]] bool open_end() const { return open_end_; }

 private:
  void check_block();

  const Source* source_;
  Lines lines_;
  bool first_ = true;
  bool counted_ = false;
  bool open_end_ = false;
  std::uint64_t block_ = 0;  // points that the last count line announced
  std::uint64_t seen_ = 0;
  std::optional<std::uint64_t> announced_;
  int headers_ = 0;  // lines of words before the points
};

/// What a look at the lines alone tells.
struct TextShape {
  char separator = ' ';
  std::size_t columns = 0;
  std::uint64_t points = 0;
  bool counted = false;  ///< PTS
  std::optional<std::uint64_t> announced;
  ColumnNames header;
  int unused_headers = 0;       ///< lines of words before the points that do not name the columns
  std::size_t unused_line = 0;  ///< the first of these
  std::string unused_text;      ///< its beginning
  bool open_end = false;
  bool open_rows = false;  ///< every line ends with a separator

  /// Whether the columns are x, y and z and need no more than that.
  [[nodiscard]] bool is_bare() const { return columns <= 3 && header.names.empty(); }
};

/// "column 3 "z"", or "column 3" where it has no name. Columns count from 0, texts from 1.
std::string column_text(const TextShape& shape, std::size_t column);

/// Reads the text once. Tabs that leave lines with different columns are blanks, if blanks do not. Throws InvalidInput.
TextShape measure(const Text& text);

/// The numbers of the points.
class PointRows {
 public:
  /// Is told of words (column, line, value), which become NaN as missing values do; throws where there must be numbers.
  using Word = std::function<void(std::size_t, std::size_t, std::string_view)>;
  PointRows(const Text& text, const TextShape& shape, Word word);
  /// The columns of the next point, null at the end; valid until the next call. Throws InvalidInput where a line has more or fewer.
  const double* next();
  /// Whether a number was beyond double's range.
  [[nodiscard]] bool overflow() const { return overflow_; }

  /// Values that were not there (is_missing()), which become NaN.
  struct Missing {
    std::uint64_t count = 0;
    std::size_t line = 0;  ///< of the first
  };
  [[nodiscard]] const std::vector<Missing>& missing() const { return missing_; }

 private:
  void take(std::size_t column, std::string_view value);

  const Source* source_;
  PointLines lines_;
  Word word_;
  char separator_;
  std::vector<double> row_;
  std::vector<Missing> missing_;
  bool overflow_ = false;
};

/// A line for each column with missing values.
std::vector<std::string> about_missing(const TextShape& shape, const std::vector<PointRows::Missing>& missing);

/// What to do with words in columns of numbers: an error.
PointRows::Word no_words(const Text& text, const TextShape& shape);

}  // namespace g3r::io
