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
};

/// What a look at the lines alone tells.
struct TextShape {
  char separator = ' ';
  std::size_t columns = 0;
  std::uint64_t points = 0;
  bool counted = false;  ///< PTS
  std::optional<std::uint64_t> announced;
  ColumnNames header;
  bool header_differs = false;  ///< a header line with another number of columns
  bool open_end = false;

  /// Whether the columns are x, y and z and need no more than that.
  [[nodiscard]] bool is_bare() const { return columns <= 3 && header.names.empty(); }
};

/// Reads the text once. Throws InvalidInput.
TextShape measure(const Text& text);

/// The numbers of the points.
class PointRows {
 public:
  /// Is told of values that are no numbers (column, line, value), which become NaN; throws where there must be numbers.
  using Word = std::function<void(std::size_t, std::size_t, std::string_view)>;
  PointRows(const Text& text, const TextShape& shape, Word word);
  /// The columns of the next point, null at the end; valid until the next call. Throws InvalidInput where a line has more or fewer.
  const double* next();
  /// Whether a number was beyond double's range.
  [[nodiscard]] bool overflow() const { return overflow_; }

 private:
  const Source* source_;
  PointLines lines_;
  Word word_;
  char separator_;
  std::vector<double> row_;
  bool overflow_ = false;
};

/// What to do with words in columns of numbers: an error.
PointRows::Word no_words(const Text& text);

}  // namespace g3r::io
