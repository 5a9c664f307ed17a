#include "io/column_names.h"

#include "io/text.h"
#include "io/text_values.h"

#include <algorithm>
#include <set>
#include <utility>

namespace g3r::io {

namespace {

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

}  // namespace

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

}  // namespace g3r::io
