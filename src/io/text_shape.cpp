#include "io/text_shape.h"

#include "io/point_lines.h"
#include "io/text_numbers.h"
#include "io/text_values.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace g3r::io {

namespace {

constexpr std::size_t kMostColumns = 1000;  // More columns mean that the file has no line ends.
constexpr std::size_t kMostBytes = 256;     // of a first line that are kept for a message

bool are_distinct(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  return std::adjacent_find(names.begin(), names.end()) == names.end();
}

// That of the points, if it gives a name for every column, but of blanks behind commas ("x, y, z") the commas.
char separator_of_names(std::string_view line, const TextShape& shape) {
  const char own = separator_of(line);
  if (own != ' ' && count_values(line, own) == shape.columns) return own;
  return count_values(line, shape.separator) == shape.columns ? shape.separator : own;
}

// Whether a line of words has a name for every column of the points. An empty cell may end the first of these.
bool fits_columns(std::string_view line, char separator, TextShape& shape) {
  const std::size_t names = count_values(line, separator);
  if (shape.open_rows && names == shape.columns + 1) ++shape.columns;
  return names == shape.columns;
}

// The line without the blanks before and in brackets: "X [m] Y [m]" has two names.
std::string attach_units(std::string_view line) {
  std::string out;
  bool in_unit = false;
  for (const char c : line) {
    const bool blank = c == ' ' || c == '\t';
    if (c == '[' || c == '(') {
      in_unit = true;
      out.erase(out.find_last_not_of(" \t") + 1);
    }
    if (!in_unit || !blank) out += c;
    if (c == ']' || c == ')') in_unit = false;
  }
  return out;
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
    const char separator = separator_of_names(line, shape);
    bool fits = fits_columns(line, separator, shape);
    std::string attached;
    std::string_view names = line;
    if (!fits && separator == ' ') {
      names = attached = attach_units(line);
      fits = fits_columns(names, separator, shape);
    }
    if (!fits && !comment && may_be_decimal_commas(line, separator, shape)) halves = lines.number();
    ColumnNames header = fits && !shape.header.axes ? column_names(names, separator) : ColumnNames();
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

}  // namespace g3r::io
