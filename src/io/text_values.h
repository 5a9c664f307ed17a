// How a line of a text with one point per line is cut into values.
#pragma once

#include "io/text.h"

#include <cstddef>
#include <string_view>

namespace g3r::io {

/// What separates the values of a line: a tab where three numbers or more stand between tabs; ';' where there is one; ',' if every comma
/// stands between two values ("0,5 0,25" has decimal commas); else blanks (' ').
char separator_of(std::string_view line);

/// The values of a line. Between separators that are not blanks a value may stand in double quotes, which are taken off and hide
/// separators; an empty value after a final separator does not count.
class Values {
 public:
  Values(std::string_view line, char separator);
  bool next(std::string_view& value);

 private:
  Tokens blanks_;
  std::string_view rest_;
  char separator_;
  bool more_;
};

/// Whether the value stands for a number that is not there: an empty cell, or what programs write in its place (NA, N/A, null, none).
bool is_missing(std::string_view value);

/// Whether the line, without blanks at its end, ends with a separator that is no blank: Values takes it for the end of the last value, and
/// where a line has one value less than others it was the end of an empty one.
bool ends_with_separator(std::string_view line, char separator);

/// Lines of words that may stand before the points: names of columns, units, what program wrote them.
inline constexpr int kMostHeaderLines = 20;

std::size_t count_values(std::string_view line, char separator);

/// Values of the line that are numbers.
std::size_t count_numbers(std::string_view line, char separator);

/// Whether the value is no number but begins like one: "0,5", "12:30".
bool is_like_number(std::string_view value);

}  // namespace g3r::io
