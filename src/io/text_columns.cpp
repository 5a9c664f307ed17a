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

void name_triple(std::vector<Property>& columns, std::size_t first, const std::array<const char*, 3>& names) {
  for (std::size_t c = 0; c < 3; ++c) columns[first + c].name = names[c];
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

ColumnFacts::ColumnFacts(std::size_t columns)
    : whole_(columns, true), channel_(columns, true), any_unit_(columns, false), any_other_(columns, false) {}

void ColumnFacts::add(const double* row) {
  constexpr double kSlack = 0.01;  // Squared lengths of unit normals may be off by this: two decimals are common.
  const std::size_t columns = whole_.size();
  for (std::size_t c = 0; c < columns; ++c) {
    if (!whole_[c]) continue;
    whole_[c] = row[c] == std::nearbyint(row[c]) && !std::isinf(row[c]);
    channel_[c] = channel_[c] && whole_[c] && row[c] >= 0 && row[c] <= 255;
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

bool ColumnFacts::are_colors(std::size_t column) const { return channel_[column] && channel_[column + 1] && channel_[column + 2]; }

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
      constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15;  // an odd number: whole numbers next to each other fall into different parts
      const std::uint64_t bits = bits_as<std::uint64_t>(value + 0.0);  // 0 and -0 are equal
      if ((bits * kSpread >> 32) % parts == part) values.push_back(value);
    });
    std::sort(values.begin(), values.end());
    if (std::adjacent_find(values.begin(), values.end()) != values.end()) return false;
  }
  return true;
}

void guess_names(std::vector<Property>& columns, const ColumnFacts& facts, std::size_t known) {
  const std::size_t count = columns.size();
  bool normals = false;
  bool colors = false;
  for (std::size_t c = known; c < count;) {
    const bool triple = c + 3 <= count;
    const bool unit = triple && !normals && facts.are_normals(c);
    if (triple && !unit && !colors && facts.are_colors(c)) {
      name_triple(columns, c, {"red", "green", "blue"});
      colors = true;
      c += 3;
    } else if (unit || count == known + 3) {  // a triple alone that is no colour: normals of any length
      name_triple(columns, c, {"nx", "ny", "nz"});
      normals = true;
      c += 3;
    } else {
      columns[c].name = "scalar_" + std::to_string(c + 1);
      ++c;
    }
  }
}

}  // namespace g3r::io
