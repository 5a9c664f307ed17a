// The names of the columns of a text with one point per line, from its header.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::io {

/// The names in a header line, one per column: known ones in our spelling, those of normals and colours where all three are there,
/// surveyors' (easting, latitude, elevation ...) as x, y and z where those are not named and at least two of the three are there.
struct ColumnNames {
  std::vector<std::string> names;
  bool axes = false;                ///< x, y and z are among them
  bool geographic = false;          ///< x or y is a longitude or latitude
  std::vector<std::string> theirs;  ///< as the header has them
};
ColumnNames column_names(std::string_view line, char separator);

/// Three columns of these names, in our spelling, that are the same but for x, y and z or for digits, normals excepted: POINT_X, POINT_Y,
/// POINT_Z or Points:0, Points:1, Points:2. Empty if there are none.
std::vector<std::size_t> like_axes(const std::vector<std::string>& names);

/// A name that occurred before gets a number: a, a_2.
void make_distinct(std::vector<std::string>& names);

}  // namespace g3r::io
