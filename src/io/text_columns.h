// The columns of a text with one point per line: how a line is cut into values, and what its columns are, by name or by value.
#pragma once

#include "io/table.h"
#include "io/text.h"

#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// What separates the values of a line: ';' where there is one; ',' if every comma stands between two values ("0,5 0,25" has decimal
/// commas); else blanks (' ').
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

std::size_t count_values(std::string_view line, char separator);

/// Values of the line that are numbers.
std::size_t count_numbers(std::string_view line, char separator);

/// Whether the value is no number but begins like one: "0,5", "12:30".
bool is_like_number(std::string_view value);

/// The names in a header line, one per column: known ones in our spelling, surveyors' (easting, latitude, elevation ...) as x, y and z
/// where those are not named.
struct ColumnNames {
  std::vector<std::string> names;
  bool axes = false;        ///< x, y and z are among them
  bool geographic = false;  ///< x or y is a longitude or latitude
};
ColumnNames column_names(std::string_view line, char separator);

/// A name that occurred before gets a number: a, a_2.
void make_distinct(std::vector<std::string>& names);

/// How the first columns of a text without names are arranged, inferred from their values.
enum class Arrangement {
  kXyz,
  kNumberedXyz,  ///< a name or number of the point, x, y, z
  kPnezd         ///< point number, northing, easting, elevation, description
};

/// Which columns hold text. `all` of its values are words that do not begin like a number.
struct TextColumn {
  bool any = false;
  bool all = false;
};

/// `points`: records of doubles, one property per column (NaN for text).
Arrangement find_arrangement(const Element& points, const std::vector<TextColumn>& text);

/// Names for columns without names, of which none holds text any more and the first `known` are named already: triples that look like
/// normals or colours, else "scalar_4" and so on.
void guess_names(Element& points, std::size_t known);

}  // namespace g3r::io
