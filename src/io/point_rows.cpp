#include "io/point_rows.h"

#include "io/text_numbers.h"
#include "io/text_values.h"

#include <limits>
#include <utility>

namespace g3r::io {

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
