#include "io/point_text.h"

#include "io/text_values.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace g3r::io {

namespace {

constexpr std::size_t kMostColumns = 1000;  // More columns mean that the file has no line ends.

// Comments start a line; CloudCompare's "//X Y Z" is one that names columns.
bool is_comment(std::string_view line) { return line[0] == '#' || line.substr(0, 2) == "//"; }

// A first line that names columns: it starts with a word and is no point whose first column holds text.
bool is_header(std::string_view line) {
  const char separator = separator_of(line);
  Values values(line, separator);
  std::string_view first;
  double number = 0;
  return values.next(first) && !is_like_number(first) && !parse_double(first, number) && count_numbers(line, separator) < 3;
}

// The names in a header line or in a comment such as "//X Y Z", one per column of the points. A comment must name x, y and z.
void find_names(const Text& text, TextShape& shape) {
  Lines lines = text.lines();
  std::string_view line;
  while (lines.next_filled(line)) {
    std::uint64_t count = 0;
    if (parse_integer(line, count)) continue;
    const bool comment = is_comment(line);
    if (!comment && !is_header(line)) break;
    const std::size_t begin = line.find_first_not_of("#/ \t");
    if (begin == std::string_view::npos) continue;
    line.remove_prefix(begin);
    const char separator = count_values(line, shape.separator) == shape.columns ? shape.separator : separator_of(line);
    if (count_values(line, separator) != shape.columns) {
      shape.header_differs = shape.header_differs || !comment;
      if (!comment && separator == ',' && shape.separator == ',' && 2 * count_values(line, separator) == shape.columns) {
        fail_at_line(text.source(), lines.number(),
                     "names " + std::to_string(shape.columns / 2) +
                         " columns, and the points have twice as many: decimal commas? write "
                         "numbers with a point, or separate columns by semicolons or blanks");
      }
      continue;
    }
    ColumnNames header = column_names(line, separator);
    if (comment && !header.axes) continue;
    shape.header = std::move(header);
    return;
  }
}

[[noreturn]] void refuse_columns(const Source& source, std::size_t number, std::string_view line, const TextShape& shape) {
  if (shape.columns > kMostColumns) {
    fail_at_line(source, number, std::to_string(shape.columns) + " columns on one line: expected one point per line");
  }
  std::string_view token;
  double value = 0;
  Values values(line, shape.separator);
  while (values.next(token)) {
    if (!parse_double(token, value)) fail_at_line(source, number, expected_number(token));
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
    if (is_comment(line) || (first_ && is_header(line))) {
      first_ = first_ && is_comment(line);
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

TextShape measure(const Text& text) {
  TextShape shape;
  PointLines lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (shape.points++ != 0) continue;
    shape.separator = separator_of(line);
    shape.columns = count_values(line, shape.separator);
    if (shape.columns < 3 || shape.columns > kMostColumns) refuse_columns(text.source(), lines.number(), line, shape);
  }
  shape.counted = lines.counted();
  shape.announced = lines.announced();
  shape.open_end = lines.open_end();
  if (shape.points != 0) find_names(text, shape);
  return shape;
}

PointRows::PointRows(const Text& text, const TextShape& shape, Word word)
    : source_(&text.source()), lines_(text), word_(std::move(word)), separator_(shape.separator), row_(shape.columns) {}

const double* PointRows::next() {
  std::string_view line;
  if (!lines_.next(line)) return nullptr;
  Values values(line, separator_);
  std::string_view token;
  std::size_t found = 0;
  while (values.next(token)) {
    double value = 0;
    if (!parse_double(token, value, &overflow_)) {
      value = std::numeric_limits<double>::quiet_NaN();
      if (found < row_.size()) word_(found, lines_.number(), token);
    }
    if (found < row_.size()) row_[found] = value;
    ++found;
  }
  if (found != row_.size()) {
    fail_at_line(*source_, lines_.number(),
                 "expected " + std::to_string(row_.size()) + " columns as on the lines before, found " + std::to_string(found));
  }
  return row_.data();
}

PointRows::Word no_words(const Text& text) {
  return [&source = text.source()](std::size_t, std::size_t line, std::string_view value) {
    fail_at_line(source, line, expected_number(value));
  };
}

}  // namespace g3r::io
