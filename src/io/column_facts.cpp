#include "io/column_facts.h"

#include "base/hash.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace g3r::io {

namespace {

void name_triple(std::vector<Property>& columns, std::size_t first, const std::array<const char*, 3>& names) {
  for (std::size_t c = 0; c < 3; ++c) columns[first + c].name = names[c];
}

}  // namespace

ColumnFacts::ColumnFacts(std::size_t columns)
    : whole_(columns, true), low_(columns, 0), high_(columns, 0), any_unit_(columns, false), any_other_(columns, false) {}

void ColumnFacts::add(const double* row) {
  constexpr double kSlack = 0.01;  // Squared lengths of unit normals may be off by this: two decimals are common.
  const std::size_t columns = whole_.size();
  for (std::size_t c = 0; c < columns; ++c) {
    if (!whole_[c]) continue;
    whole_[c] = row[c] == std::nearbyint(row[c]) && !std::isinf(row[c]);
    low_[c] = std::min(low_[c], row[c]);
    high_[c] = std::max(high_[c], row[c]);
  }
  for (std::size_t c = 0; c + 3 <= columns; ++c) {
    if (any_other_[c]) continue;
    const double square = row[c] * row[c] + row[c + 1] * row[c + 1] + row[c + 2] * row[c + 2];
    if (std::abs(square - 1) <= kSlack) {
      any_unit_[c] = true;
    } else {
      any_other_[c] = square != 0 && !std::isnan(square);
    }
  }
  if (points_++ > 0) {
    by_one_ = by_one_ && row[0] == last_ + 1;
    increase_ = increase_ && row[0] > last_;
  }
  last_ = row[0];
}

bool ColumnFacts::are_colors(std::size_t column) const { return are_bytes(column) && are_bytes(column + 1) && are_bytes(column + 2); }

bool ColumnFacts::are_counts(std::size_t column) const {
  bool beyond = false;
  for (std::size_t c = column; c < column + 3; ++c) {
    if (!are_levels(c, HUGE_VAL)) return false;
    beyond = beyond || high_[c] > 1;
  }
  return beyond;
}

bool ColumnFacts::are_deep_colors(std::size_t column) const {
  constexpr double kMost = 65535;
  return are_counts(column) && are_levels(column, kMost) && are_levels(column + 1, kMost) && are_levels(column + 2, kMost);
}

bool ColumnFacts::count_points() const {
  constexpr std::uint64_t kLeast = 10;  // Fewer lines may count by chance.
  return points_ >= kLeast && by_one_;
}

Arrangement find_arrangement(const ColumnFacts& facts, const std::vector<TextColumn>& text, const std::function<bool()>& all_differ) {
  constexpr std::size_t kDescription = 4;
  if (text.size() < 4 || text[1].any || text[2].any || text[3].any) return Arrangement::kXyz;
  if (text[0].any && !text[0].all) return Arrangement::kXyz;
  // Numbers of points beside coordinates that are all whole could not be distinguished from an x.
  const bool fractions = !facts.are_whole(1) || !facts.are_whole(2) || !facts.are_whole(3);
  if (text.size() > kDescription && text[kDescription].any &&
      (text[0].all || (fractions && facts.are_whole(0) && (facts.increase() || all_differ())))) {
    return Arrangement::kPnezd;
  }
  return text[0].all || (fractions && facts.count_points()) ? Arrangement::kNumberedXyz : Arrangement::kXyz;
}

bool all_differ(std::uint64_t count, const std::function<void(const std::function<void(double)>&)>& for_each_value, std::size_t at_once) {
  const std::uint64_t parts = count / at_once + 1;
  std::vector<double> values;
  for (std::uint64_t part = 0; part < parts; ++part) {
    values.clear();
    for_each_value([&](double value) {
      const std::uint64_t bits = bits_as<std::uint64_t>(value + 0.0);  // 0 and -0 are equal
      if ((bits * kGolden >> 32) % parts == part) values.push_back(value);
    });
    std::sort(values.begin(), values.end());
    if (std::adjacent_find(values.begin(), values.end()) != values.end()) return false;
  }
  return true;
}

std::string doubt_of_order(const ColumnFacts& facts, std::size_t columns) {
  const auto are_coordinates = [&](std::size_t c) {  // three that are neither colours nor normals
    return c + 3 <= columns && !(facts.are_whole(c) && facts.are_whole(c + 1) && facts.are_whole(c + 2)) && !facts.are_normals(c);
  };
  const std::string taken = "the first three columns are taken for x, y and z, and ";
  const std::string remedy = "; if so, name the columns in a first line, for example ";
  if (columns >= 6 && facts.are_colors(0) && (are_coordinates(3) || are_coordinates(4)))
    return taken + "look like colours, whole numbers from 0 to 255" + remedy + "red,green,blue,x,y,z";
  if (columns >= 6 && facts.are_normals(0) && are_coordinates(3))
    return taken + "look like normals, all of length 1" + remedy + "nx,ny,nz,x,y,z";
  if (columns >= 4 && facts.are_whole(0) && !facts.are_whole(1) && !facts.are_whole(2) && !facts.are_whole(3))
    return taken + "the three after the first look more like coordinates" + remedy + "intensity,x,y,z";
  return "";
}

std::string guess_names(std::vector<Property>& columns, const ColumnFacts& facts, std::size_t known, bool counted) {
  const std::size_t count = columns.size();
  const bool alone = count == known + 3;
  // The first may be an intensity before colours, where no normals are among these columns.
  const bool later = count >= known + 4 && facts.are_colors(known + 1) && !facts.are_normals(known) &&
                     (count < known + 6 || !facts.are_normals(known + 3));
  bool normals = false;
  bool colors = false;
  for (std::size_t c = known; c < count;) {
    const bool triple = c + 3 <= count;
    const bool unit = triple && !normals && facts.are_normals(c);
    if (c == known && later && counted) {
      columns[c++].name = "intensity";
    } else if (triple && !unit && !colors && (facts.are_colors(c) || (alone && facts.are_deep_colors(c)))) {
      name_triple(columns, c, {"red", "green", "blue"});
      colors = true;
      c += 3;
    } else if (unit || (triple && alone && !facts.are_counts(c))) {  // a triple alone that is no colour: normals of any length
      name_triple(columns, c, {"nx", "ny", "nz"});
      normals = true;
      c += 3;
    } else {
      columns[c].name = "scalar_" + std::to_string(c + 1);
      ++c;
    }
  }
  const std::string taken =
      "columns " + std::to_string(known + 1) + " to " + std::to_string(known + 3) + " are taken for red, green and blue";
  if (colors && alone && !facts.are_colors(known))
    return taken + " of 16 bits; if they are others, name the columns in a first line, for example x,y,z,intensity,returns,class";
  if (colors && later && facts.are_bytes(known) && !counted)
    return taken + "; if an intensity comes before the colours, name the columns in a first line: x,y,z,intensity,red,green,blue";
  return "";
}

}  // namespace g3r::io
