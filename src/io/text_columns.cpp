#include "io/text_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace g3r::io {

namespace {

// Where a quoted value at the start of the text ends, 0 if there is none.
std::size_t quoted_length(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos || text[begin] != '"') return 0;
  for (std::size_t at = begin + 1; (at = text.find('"', at)) != std::string_view::npos; at += 2) {
    if (at + 1 == text.size() || text[at + 1] != '"') return at + 1;
  }
  return 0;
}

// Whether a separator, one of ',' and ';', stands in the line and not within a quoted value.
bool has_separator(std::string_view line, char wanted) {
  for (std::size_t at = 0; at < line.size(); ++at) {
    at = line.find_first_of(",;", at + quoted_length(line.substr(at)));
    if (at == std::string_view::npos) return false;
    if (line[at] == wanted) return true;
  }
  return false;
}

bool is_number(std::string_view value) {
  double number = 0;
  return parse_double(value, number);
}

// "5 0" between two commas: the commas are decimal ones.
bool are_numbers(std::string_view field) {
  Tokens parts(field);
  std::string_view part;
  std::size_t count = 0;
  for (; parts.next(part); ++count) {
    if (!is_number(part)) return false;
  }
  return count > 1;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

// Units in brackets are ignored: "X [m]" is x.
std::string without_unit(std::string_view name) { return lower_case(trim(name.substr(0, name.find_first_of("[(")))); }

// The name of a column without quotes; known names in our spelling.
std::string column_name(std::string_view text) {
  while (!text.empty() && (text.front() == '"' || text.front() == '\'')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == '"' || text.back() == '\'')) text.remove_suffix(1);
  constexpr std::pair<std::string_view, std::string_view> kNames[] = {
      {"x", "x"},         {"y", "y"},         {"z", "z"},         {"nx", "nx"},
      {"ny", "ny"},       {"nz", "nz"},       {"normal_x", "nx"}, {"normal_y", "ny"},
      {"normal_z", "nz"}, {"r", "red"},       {"g", "green"},     {"b", "blue"},
      {"red", "red"},     {"green", "green"}, {"blue", "blue"},   {"confidence", "confidence"}};
  const std::string lower = without_unit(text);
  for (const auto& [name, ours] : kNames) {
    if (lower == name) return std::string(ours);
  }
  return std::string(text);
}

bool has_name(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

struct AxisName {
  std::string_view theirs;
  std::string_view ours;
  bool geographic;
};

// Those that come first are preferred.
constexpr AxisName kAxisNames[] = {{"easting", "x", false}, {"east", "x", false},      {"northing", "y", false}, {"north", "y", false},
                                   {"height", "z", false},  {"elevation", "z", false}, {"altitude", "z", false}, {"elev", "z", false},
                                   {"alt", "z", false},     {"longitude", "x", true},  {"lon", "x", true},       {"long", "x", true},
                                   {"latitude", "y", true}, {"lat", "y", true}};

double value_at(const Element& points, std::size_t point, std::size_t column) {
  return load<double>(points.data.data() + (point * points.properties.size() + column) * sizeof(double));
}

bool is_whole(const Element& points, std::size_t column) {
  for (std::size_t i = 0; i < points.count; ++i) {
    const double value = value_at(points, i, column);
    if (value != std::nearbyint(value) || std::isinf(value)) return false;
  }
  return true;
}

bool all_different(const Element& points, std::size_t column) {
  std::vector<double> values(static_cast<std::size_t>(points.count));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = value_at(points, i, column);
  std::sort(values.begin(), values.end());
  return std::adjacent_find(values.begin(), values.end()) == values.end();
}

// 1, 2, 3, ...: fewer lines may be so by chance.
bool counts_points(const Element& points, std::size_t column) {
  constexpr std::uint64_t kLeast = 10;
  if (points.count < kLeast) return false;
  for (std::size_t i = 1; i < points.count; ++i) {
    if (value_at(points, i, column) != value_at(points, i - 1, column) + 1) return false;
  }
  return true;
}

bool are_normals(const Element& points, std::size_t column) {
  constexpr double kSlack = 0.01;  // two decimals are common
  bool any = false;
  for (std::size_t i = 0; i < points.count; ++i) {
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a) square += value_at(points, i, column + a) * value_at(points, i, column + a);
    if (std::abs(square - 1) <= kSlack) {
      any = true;
    } else if (square != 0 && !std::isnan(square)) {
      return false;
    }
  }
  return any;
}

bool are_colors(const Element& points, std::size_t column) {
  for (std::size_t i = 0; i < points.count; ++i) {
    for (std::size_t c = column; c < column + 3; ++c) {
      const double value = value_at(points, i, c);
      if (!(value >= 0 && value <= 255 && value == std::nearbyint(value))) return false;
    }
  }
  return true;
}

void name_triple(Element& points, std::size_t first, const std::array<const char*, 3>& names) {
  for (std::size_t c = 0; c < 3; ++c) points.properties[first + c].name = names[c];
}

}  // namespace

char separator_of(std::string_view line) {
  if (has_separator(line, ';')) return ';';
  if (!has_separator(line, ',')) return ' ';
  Values fields(line, ',');
  std::string_view field;
  while (fields.next(field)) {
    if (are_numbers(field)) return ' ';
  }
  return ',';
}

Values::Values(std::string_view line, char separator) : blanks_(line), rest_(line), separator_(separator), more_(!line.empty()) {
  if (separator != ' ' && more_ && line.back() == separator) rest_.remove_suffix(1);
}

bool Values::next(std::string_view& value) {
  if (separator_ == ' ') return blanks_.next(value);
  if (!more_) return false;
  const std::size_t end = rest_.find(separator_, quoted_length(rest_));
  value = trim(rest_.substr(0, end));
  if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = trim(value.substr(1, value.size() - 2));
  more_ = end != std::string_view::npos;
  if (more_) rest_.remove_prefix(end + 1);
  return true;
}

std::size_t count_values(std::string_view line, char separator) {
  Values values(line, separator);
  std::string_view value;
  std::size_t count = 0;
  while (values.next(value)) ++count;
  return count;
}

std::size_t count_numbers(std::string_view line, char separator) {
  Values values(line, separator);
  std::string_view value;
  std::size_t count = 0;
  while (values.next(value)) count += is_number(value) ? 1 : 0;
  return count;
}

bool is_like_number(std::string_view value) { return value.find_first_of("+-.0123456789") == 0; }

ColumnNames column_names(std::string_view line, char separator) {
  ColumnNames found;
  Values values(line, separator);
  std::string_view value;
  while (values.next(value)) found.names.push_back(column_name(value));
  std::vector<std::string> names = found.names;
  bool geographic = false;
  for (const AxisName& axis : kAxisNames) {
    if (has_name(names, axis.ours)) continue;
    const auto is_theirs = [&](const std::string& name) { return without_unit(name) == axis.theirs; };
    const auto column = std::find_if(names.begin(), names.end(), is_theirs);
    if (column == names.end()) continue;
    *column = axis.ours;
    geographic = geographic || axis.geographic;
  }
  if (!has_name(names, "x") || !has_name(names, "y") || !has_name(names, "z")) return found;
  return {std::move(names), true, geographic};
}

void make_distinct(std::vector<std::string>& names) {
  std::set<std::string> used;
  for (std::string& name : names) {
    const std::string first = name;
    for (int k = 2; !used.insert(name).second; ++k) name = first + "_" + std::to_string(k);
  }
}

Arrangement find_arrangement(const Element& points, const std::vector<TextColumn>& text) {
  constexpr std::size_t kDescription = 4;
  if (points.properties.size() < 4 || text[1].any || text[2].any || text[3].any) return Arrangement::kXyz;
  if (text[0].any && !text[0].all) return Arrangement::kXyz;
  // Numbers of points beside coordinates that are all whole could not be distinguished from an x.
  const bool fractions = !is_whole(points, 1) || !is_whole(points, 2) || !is_whole(points, 3);
  if (points.properties.size() > kDescription && text[kDescription].any &&
      (text[0].all || (fractions && is_whole(points, 0) && all_different(points, 0)))) {
    return Arrangement::kPnezd;
  }
  return text[0].all || (fractions && counts_points(points, 0)) ? Arrangement::kNumberedXyz : Arrangement::kXyz;
}

void guess_names(Element& points, std::size_t known) {
  const std::size_t columns = points.properties.size();
  bool normals = false;
  bool colors = false;
  for (std::size_t c = known; c < columns;) {
    const bool triple = c + 3 <= columns;
    const bool unit = triple && !normals && are_normals(points, c);
    if (triple && !unit && !colors && are_colors(points, c)) {
      name_triple(points, c, {"red", "green", "blue"});
      colors = true;
      c += 3;
    } else if (unit || columns == known + 3) {  // a triple alone that is no colour: normals of any length
      name_triple(points, c, {"nx", "ny", "nz"});
      normals = true;
      c += 3;
    } else {
      points.properties[c].name = "scalar_" + std::to_string(c + 1);
      ++c;
    }
  }
}

}  // namespace g3r::io
