#include "io/point_lines.h"

#include "io/text_numbers.h"
#include "io/text_values.h"

#include <string>

namespace g3r::io {

bool is_comment(std::string_view line) { return line[0] == '#' || line.substr(0, 2) == "//"; }

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

}  // namespace g3r::io
