#include "io/point_text.h"

#include "io/text_values.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace g3r::io {

namespace {

constexpr std::size_t kMostColumns = 1000;  // More columns mean that the file has no line ends.
constexpr std::size_t kMostBytes = 256;     // of a first line that are kept for a message

// Comments start a line; CloudCompare's "//X Y Z" is one that names columns.
bool is_comment(std::string_view line) { return line[0] == '#' || line.substr(0, 2) == "//"; }

// A first line that names columns: it starts with a word and is no point whose first column holds text.
bool is_header(std::string_view line) {
  const char separator = separator_of(line);
  Values values(line, separator);
  std::string_view value;
  double number = 0;
  if (!values.next(value) || is_like_number(value) || parse_double(value, number)) return false;
  bool has_gap = false;
  while (values.next(value)) has_gap = has_gap || is_missing(value);
  const std::size_t numbers = count_numbers(line, separator);
  return numbers < 3 && !(numbers == 2 && has_gap);  // a point may lack a number
}

bool are_distinct(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  return std::adjacent_find(names.begin(), names.end()) == names.end();
}

// Whether a line of words has a name for every column of the points. An empty cell may end the first of these.
bool fits_columns(std::string_view line, char separator, TextShape& shape) {
  const std::size_t names = count_values(line, separator);
  if (shape.open_rows && names == shape.columns + 1) ++shape.columns;
  return names == shape.columns;
}

// Half as many names as columns, and all separated by commas.
bool may_be_decimal_commas(std::string_view line, char separator, const TextShape& shape) {
  return separator == ',' && shape.separator == ',' && 2 * count_values(line, separator) == shape.columns;
}

[[noreturn]] void refuse_decimal_commas(const Source& source, std::size_t number, const TextShape& shape) {
  fail_at_line(source, number,
               "names " + std::to_string(shape.columns / 2) +
                   " columns, and the points have twice as many: decimal commas? write numbers with a point, or separate columns by "
                   "semicolons or blanks");
}

// The names in one of the lines of words before the points, or in a comment such as "//X Y Z", one per column of the points. A comment must
// name x, y and z; of other lines the first that does, else the last with names that differ (units do not), gives the names.
void find_names(const Text& text, TextShape& shape) {
  constexpr std::size_t kShown = 40;  // bytes of a line that a message shows
  Lines lines = text.lines();
  std::string_view line;
  int headers = 0;
  const auto leave_unused = [&](std::size_t number, std::string_view what) {
    if (shape.unused_headers++ > 0) return;
    shape.unused_line = number;
    shape.unused_text = what.substr(0, kShown);
  };
  std::size_t named_by = 0;
  std::size_t halves = 0;  // a line with half as many names as there are columns
  std::string named_text;
  while (lines.next_filled(line)) {
    std::uint64_t count = 0;
    if (parse_integer(line, count)) continue;
    const bool comment = is_comment(line);
    if (!comment && (!is_header(line) || ++headers > kMostHeaderLines)) break;
    const std::size_t begin = line.find_first_not_of("#/ \t");
    if (begin == std::string_view::npos) continue;
    line.remove_prefix(begin);
    const char separator = count_values(line, shape.separator) == shape.columns ? shape.separator : separator_of(line);
    const bool fits = fits_columns(line, separator, shape);
    if (!fits && !comment && may_be_decimal_commas(line, separator, shape)) halves = lines.number();
    ColumnNames header = fits && !shape.header.axes ? column_names(line, separator) : ColumnNames();
    const bool is_worse = !shape.header.names.empty() && !are_distinct(header.names);
    if (header.names.empty() || is_worse || (comment && !header.axes)) {
      if (!comment) leave_unused(lines.number(), line);
      continue;
    }
    if (named_by != 0) leave_unused(named_by, named_text);
    shape.header = std::move(header);
    named_by = comment ? 0 : lines.number();
    named_text = line;
  }
  if (halves != 0 && shape.header.names.empty()) refuse_decimal_commas(text.source(), halves, shape);
}

[[noreturn]] void refuse_columns(const Source& source, std::size_t number, std::string_view line, const TextShape& shape) {
  if (shape.columns > kMostColumns) {
    fail_at_line(source, number, std::to_string(shape.columns) + " columns on one line: expected one point per line");
  }
  std::string_view token;
  double value = 0;
  Values values(line, shape.separator);
  while (values.next(token)) {
    if (!parse_double(token, value) && !is_missing(token)) fail_at_line(source, number, expected_number(token));
  }
  fail_at_line(source, number, "expected at least three columns (x y z), found " + std::to_string(shape.columns));
}

}  // namespace

void PointLines::check_block() {
  if (counted_ && seen_ > block_ && !announced_) announced_ = block_;
  if (counted_ && seen_ < block_) {
    fail_at_line(*source_, lines_.number(),
                 "expected " + std::to_string(block_) + " points as the count line says, found " + std::to_string(seen_) +
                     " lines of columns (truncated?)");
  }
}

bool PointLines::next(std::string_view& line) {
  while (lines_.next_filled(line)) {
    if (is_comment(line)) continue;
    if (first_ && headers_ < kMostHeaderLines && is_header(line)) {
      ++headers_;
      continue;
    }
    open_end_ = !lines_.ended();
    std::uint64_t count = 0;
    const bool counts = (first_ || counted_) && parse_integer(line, count);
    first_ = false;
    if (!counts) {
      ++seen_;
      return true;
    }
    check_block();
    counted_ = true;
    block_ = count;
    seen_ = 0;
  }
  check_block();
  return false;
}

std::string column_text(const TextShape& shape, std::size_t column) {
  const std::vector<std::string>& names = shape.header.theirs;
  const std::string text = "column " + std::to_string(column + 1);
  return column < names.size() ? text + " " + quote(names[column]) : text;
}

TextShape measure(const Text& text) {
  TextShape shape;
  PointLines lines(text);
  std::string_view line;
  std::string first_line;
  std::size_t first_number = 0;
  std::size_t by_blanks = 0;  // columns, if tabs are no more than blanks
  bool tabs_fit = true;
  bool blanks_fit = true;
  while (lines.next(line)) {
    if (shape.points++ != 0) {
      if (shape.separator == '\t') {
        tabs_fit = tabs_fit && count_values(line, '\t') == shape.columns;
        blanks_fit = blanks_fit && count_values(line, ' ') == by_blanks;
      }
      // A line with one more value and no separator at the end shows that those which have it there end with an empty cell.
      if (shape.open_rows && !ends_with_separator(line, shape.separator) && count_values(line, shape.separator) > shape.columns) {
        shape.open_rows = false;
        ++shape.columns;
      }
      continue;
    }
    shape.separator = separator_of(line);
    shape.columns = count_values(line, shape.separator);
    shape.open_rows = ends_with_separator(line, shape.separator);
    by_blanks = count_values(line, ' ');
    first_number = lines.number();
    first_line = line.substr(0, kMostBytes);
    if (shape.columns > kMostColumns) refuse_columns(text.source(), first_number, line, shape);
  }
  if (shape.separator == '\t' && !tabs_fit && blanks_fit) {
    shape.separator = ' ';
    shape.columns = by_blanks;
    shape.open_rows = false;
  }
  shape.counted = lines.counted();
  shape.announced = lines.announced();
  shape.open_end = lines.open_end();
  if (shape.points != 0) find_names(text, shape);
  if (shape.points != 0 && shape.columns < 3) refuse_columns(text.source(), first_number, first_line, shape);
  return shape;
}

PointRows::PointRows(const Text& text, const TextShape& shape, Word word)
    : source_(&text.source()),
      lines_(text),
      word_(std::move(word)),
      separator_(shape.separator),
      row_(shape.columns),
      missing_(shape.columns) {}

void PointRows::take(std::size_t column, std::string_view value) {
  if (parse_double(value, row_[column], &overflow_)) return;
  row_[column] = std::numeric_limits<double>::quiet_NaN();
  if (!is_missing(value)) return word_(column, lines_.number(), value);
  if (missing_[column].count++ == 0) missing_[column].line = lines_.number();
}

const double* PointRows::next() {
  std::string_view line;
  if (!lines_.next(line)) return nullptr;
  Values values(line, separator_);
  std::string_view token;
  std::size_t found = 0;
  for (; values.next(token); ++found) {
    if (found < row_.size()) take(found, token);
  }
  if (found + 1 == row_.size() && ends_with_separator(line, separator_)) take(found++, "");
  if (found != row_.size()) {
    fail_at_line(*source_, lines_.number(),
                 "expected " + std::to_string(row_.size()) + " columns as on the lines before, found " + std::to_string(found) +
                     (found > row_.size() ? ""
                      : separator_ == ' ' ? " (nan stands for a number that is not there)"
                                          : " (also an empty cell needs its separator)"));
  }
  return row_.data();
}

std::vector<std::string> about_missing(const TextShape& shape, const std::vector<PointRows::Missing>& missing) {
  std::vector<std::string> lines;
  for (std::size_t c = 0; c < missing.size(); ++c) {
    if (missing[c].count == 0 || missing[c].count == shape.points) continue;  // a column without any number is left out, or an error
    const std::string count = missing[c].count == 1 ? "one line" : std::to_string(missing[c].count) + " lines";
    lines.push_back(column_text(shape, c) + " has no number in " + count + ", first in line " + std::to_string(missing[c].line) +
                    ": read as nan (not a number)");
  }
  return lines;
}

PointRows::Word no_words(const Text& text, const TextShape& shape) {
  return [&source = text.source(), &shape](std::size_t column, std::size_t line, std::string_view value) {
    fail_at_line(source, line, expected_number(value, " in " + column_text(shape, column)));
  };
}

}  // namespace g3r::io
