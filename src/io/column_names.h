// The names of the columns of a text with one point per line, from its header.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

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

}  // namespace g3r::io
