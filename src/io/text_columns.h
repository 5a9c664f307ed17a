// The columns of a text with one point per line: how a line is cut into values, and what its columns are, by name or by value.
#pragma once

#include "io/table.h"
#include "io/text.h"

#include <cstdint>
#include <functional>
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

/// What the values of columns are like, told point by point. Columns with text have NaN in its place.
class ColumnFacts {
 public:
  explicit ColumnFacts(std::size_t columns);
  /// Takes note of a point.
  void add(const double* row);
  /// Whether a column holds whole numbers.
  [[nodiscard]] bool are_whole(std::size_t column) const { return whole_[column]; }
  /// Whether a column and the next two hold whole numbers 0..255.
  [[nodiscard]] bool are_colors(std::size_t column) const;
  /// Whether a column and the next two hold vectors of length 1, or 0 here and there.
  [[nodiscard]] bool are_normals(std::size_t column) const { return any_unit_[column] && !any_other_[column]; }
  /// Whether the first column is 1 more from point to point, in more points than may be so by chance.
  [[nodiscard]] bool count_points() const;
  /// Whether the first column becomes larger from point to point.
  [[nodiscard]] bool increase() const { return increase_; }

 private:
  std::uint64_t points_ = 0;
  std::vector<bool> whole_;
  std::vector<bool> channel_;    // whole numbers 0..255
  std::vector<bool> any_unit_;   // of the triple that begins at the column
  std::vector<bool> any_other_;  // neither 0 nor of length 1
  double last_ = 0;              // of the first column
  bool increase_ = true;
  bool by_one_ = true;
};

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

/// `all_differ` says whether all values of the first column differ, which takes long and is seldom asked.
Arrangement find_arrangement(const ColumnFacts& facts, const std::vector<TextColumn>& text, const std::function<bool()>& all_differ);

/// Whether all of some numbers differ, of which for_each_value(take) calls take(number) for each, as often as it is called. No more than
/// about `at_once` are in memory.
bool all_differ(std::uint64_t count, const std::function<void(const std::function<void(double)>&)>& for_each_value,
                std::size_t at_once = std::size_t{1} << 21);

/// Names for columns without names, of which none holds text any more and the first `known` are named already: triples that look like
/// normals or colours, else "scalar_4" and so on.
void guess_names(std::vector<Property>& columns, const ColumnFacts& facts, std::size_t known);

}  // namespace g3r::io
